//! The command line of the program, and its own window.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use clap::Parser;
use plisse::{Error, Result};
use plisse_studio::automation::driver::Driver;
use plisse_studio::automation::script::{self, Step};
use plisse_studio::view::Graphics;
use plisse_studio::window::Window;
use plisse_studio::{Start, Studio, guard};

/// See wrinkles, paint them, tune them, export them.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// A model (.glb, .gltf, .obj, .ply, or square, curtain, zeppelin, shirt, sleeve), a scene
    /// (.toml) or a document (.plisse.json)
    file: Option<PathBuf>,
    /// Draw on the processor, for machines without a GPU
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
    /// Write no autosaves
    #[arg(long)]
    no_autosave: bool,
    /// Print milliseconds per frame of every view, on a sheet of 100,000 vertices, and quit; no
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
    let steps = steps(arguments)?;
    let driver = (!steps.is_empty()).then(|| Driver::new(steps));
    let failure = Arc::new(Mutex::new(None));
    let autosaves = !arguments.no_autosave && driver.is_none();
    let program = Program {
        graphics: Graphics::own(!arguments.cpu),
        autosave_folder: autosaves.then(guard::usual_folder).flatten(),
        file: arguments.file.clone(),
        driver,
        failure: Arc::clone(&failure),
    };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_inner_size(size(&arguments.size)?)
            .with_title("Plissé Studio")
            .with_app_id("plisse-studio"),
        ..Default::default()
    };
    eframe::run_native(
        "plisse-studio",
        options,
        Box::new(|context| Ok(Box::new(program.window(&context.egui_ctx)?))),
    )
    .map_err(|e| {
        let fix = "run it on a desktop, or install a Vulkan driver";
        Error::numeric("window", format!("it could not be opened ({e}); {fix}"))
    })?;
    match failure.lock().ok().and_then(|mut f| f.take()) {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// Width and height (points) in a text such as 1280x800.
fn size(text: &str) -> Result<[f32; 2]> {
    let size =
        text.split_once('x').and_then(|(w, h)| Some([w.parse::<f32>().ok()?, h.parse().ok()?]));
    let size = size.filter(|s| s.iter().all(|x| (200.0..=8192.0).contains(x)));
    size.ok_or_else(|| {
        let problem = format!("\"{text}\" is no size; give WIDTHxHEIGHT, such as 1280x800");
        Error::value("--size", problem)
    })
}

/// The steps of the script, and those of the screenshot.
fn steps(arguments: &Arguments) -> Result<Vec<Step>> {
    let mut steps = Vec::new();
    if let Some(path) = &arguments.script {
        steps = script::parse(&std::fs::read_to_string(path).map_err(|e| Error::reading(path, e))?);
    }
    if let Some(path) = &arguments.screenshot {
        steps.extend(script::parse(&format!("hold\nsettle\nscreenshot {}\nquit", path.display())));
    }
    Ok(steps)
}

/// The program before its window is open.
struct Program {
    graphics: Graphics,
    autosave_folder: Option<PathBuf>,
    file: Option<PathBuf>,
    driver: Option<Driver>,
    failure: Arc<Mutex<Option<Error>>>,
}

impl Program {
    fn window(self, ctx: &egui::Context) -> Result<Window> {
        ctx.set_theme(egui::Theme::Light);
        let theirs = ctx.clone();
        let mut studio = Studio::new(Start {
            graphics: self.graphics,
            autosave_folder: self.autosave_folder,
            request_repaint: Arc::new(move || theirs.request_repaint()),
        })?;
        match self.file.as_ref().map(|f| f.to_string_lossy().into_owned()) {
            Some(name) if plisse_live::models::NAMES.contains(&name.as_str()) => {
                studio.show_own(&name)
            }
            Some(path) => studio.open(Path::new(&path)),
            None => {}
        }
        Ok(Window { studio, driver: self.driver, failure: self.failure })
    }
}
