//! The program in a window of its own, as the command line asks for it.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use clap::Parser;
use plisse::{Error, Result};
use plisse_studio::automation::driver::Driver;
use plisse_studio::view::Graphics;
use plisse_studio::window::Window;
use plisse_studio::{Start, Studio, automation::script, guard};

/// See wrinkles, paint them, tune them, export them.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// A model (.glb, .gltf, .obj, .ply, or square, curtain, zeppelin, shirt, sleeve), a scene
    /// (.toml) or a document (.plisse.json)
    file: Option<PathBuf>,
    /// Draw by the processor, for machines without a GPU
    #[arg(long)]
    cpu: bool,
    /// Run the commands in this file
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Write a picture of the window here once it has settled, and quit
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,
    /// Size of the window (points)
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    size: String,
    /// Keep no autosaves
    #[arg(long)]
    no_autosave: bool,
    /// Print milliseconds a frame of every view, on a sheet of 100,000 vertices, and quit; no
    /// window opens
    #[arg(long)]
    measure: bool,
}

pub(crate) fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = std::io::Write::write_all(
                &mut std::io::stderr(),
                format!("plisse-studio: {error}\n").as_bytes(),
            );
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    if arguments.measure {
        return plisse_studio::automation::measure::run(!arguments.cpu);
    }
    let size = arguments
        .size
        .split_once('x')
        .and_then(|(w, h)| Some([w.parse::<f32>().ok()?, h.parse::<f32>().ok()?]));
    let size = size.filter(|s| s.iter().all(|x| (200.0..=8192.0).contains(x)));
    let size = size.ok_or_else(|| {
        Error::value(
            "--size",
            format!("\"{}\" is no size; give WIDTHxHEIGHT, such as 1280x800", arguments.size),
        )
    })?;
    let mut steps = Vec::new();
    if let Some(path) = &arguments.script {
        steps = script::parse(&std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?);
    }
    if let Some(path) = &arguments.screenshot {
        steps.extend(script::parse(&format!("hold\nsettle\nscreenshot {}\nquit", path.display())));
    }
    let driver = (!steps.is_empty()).then(|| Driver::new(steps));
    let failure = Arc::new(std::sync::Mutex::new(None));
    let seen = Arc::clone(&failure);
    let (gpu, file) = (!arguments.cpu, arguments.file.clone());
    let keep = (!arguments.no_autosave && driver.is_none()).then(guard::usual_folder).flatten();
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_inner_size(size)
            .with_title("Plissé Studio")
            .with_app_id("plisse-studio"),
        ..Default::default()
    };
    let create = move |context: &eframe::CreationContext<'_>| -> std::result::Result<
        Box<dyn eframe::App>,
        Box<dyn std::error::Error + Send + Sync>,
    > {
        context.egui_ctx.set_theme(egui::Theme::Light);
        let ctx = context.egui_ctx.clone();
        let mut studio = Studio::new(Start {
            graphics: Graphics::own(gpu),
            autosave_folder: keep,
            request_repaint: Arc::new(move || ctx.request_repaint()),
        })?;
        match file.as_ref().map(|f| f.to_string_lossy().into_owned()) {
            Some(name) if plisse_live::models::NAMES.contains(&name.as_str()) => {
                studio.show_own(&name)
            }
            Some(path) => studio.open(std::path::Path::new(&path)),
            None => {}
        }
        Ok(Box::new(Window { studio, driver, failure: seen }))
    };
    eframe::run_native("plisse-studio", options, Box::new(create)).map_err(|e| {
        Error::numeric(
            "window",
            format!(
                "it could not be opened ({e}); run it on a desktop, or install a Vulkan driver"
            ),
        )
    })?;
    match failure.lock().ok().and_then(|mut f| f.take()) {
        Some(error) => Err(error),
        None => Ok(()),
    }
}
