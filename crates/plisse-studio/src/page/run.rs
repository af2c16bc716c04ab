//! The program in a page: its start, and the files that come and go with each frame.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::{egui_wgpu, wgpu};
use js_sys::{Array, Uint8Array};
use plisse::io::disk;
use plisse_gpu::Gpu;
use send_wrapper::SendWrapper;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::spawn_local;

use super::asked::Asked;
use super::bindings::{call, call_and_wait, tell, text_of};
use super::files;
use crate::automation::driver::Driver;
use crate::automation::script;
use crate::open;
use crate::studio::{Start, Studio};
use crate::view::Graphics;
use crate::view::renderer::ShowTexture;
use crate::window::Window;

/// Folder of autosaves.
const AUTOSAVES: &str = "autosave";
/// Path of the autosave that an earlier visit left behind.
const LEFTOVER: &str = "autosave/autosave-0.plisse.json";

thread_local! {
    /// True if there is an autosave of this visit.
    static KEEPS: Cell<bool> = const { Cell::new(false) };
}

/// Starts the program in the page.
pub fn start() {
    // A logger that is there already is as good.
    let _ = eframe::WebLogger::init(log::LevelFilter::Warn);
    spawn_local(async {
        if let Err(error) = run().await {
            tell("failed", &text_of(&error));
        }
    });
}

async fn run() -> Result<(), JsValue> {
    let told = |error: plisse::Error| JsValue::from(error.to_string());
    let pair = |pair: JsValue| {
        let pair: Array = pair.into();
        (text_of(&pair.get(0)), text_of(&pair.get(1)))
    };
    let asked =
        Asked::from_pairs(Array::from(&call("asked", &[])?).iter().map(pair)).map_err(told)?;
    for file in &asked.files {
        let bytes = Uint8Array::new(&call_and_wait("load", &[&file.into()]).await?).to_vec();
        disk::store().put(Path::new(file), bytes);
    }
    let mut driver = None;
    if let Some(name) = &asked.script {
        let bytes = Uint8Array::new(&call_and_wait("load", &[&name.into()]).await?).to_vec();
        driver = Some(Driver::new(script::parse(&String::from_utf8_lossy(&bytes))));
    }
    if let Some(left) = call("kept", &[])?.as_string() {
        disk::store().put(Path::new(LEFTOVER), left.into_bytes());
    }
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = if asked.webgl {
        wgpu::Backends::GL
    } else {
        wgpu::Backends::BROWSER_WEBGPU | wgpu::Backends::GL
    };
    let mut options = eframe::WebOptions::default();
    options.wgpu_options.wgpu_setup = setup.into();
    let canvas: web_sys::HtmlCanvasElement = call("canvas", &[])?.dyn_into()?;
    let create = move |context: &eframe::CreationContext<'_>| -> Result<
        Box<dyn eframe::App>,
        Box<dyn std::error::Error + Send + Sync>,
    > { Ok(Box::new(PageWindow(window(context, driver, &asked)?))) };
    eframe::WebRunner::new().start(canvas, options, Box::new(create)).await
}

fn window(
    context: &eframe::CreationContext<'_>,
    driver: Option<Driver>,
    asked: &Asked,
) -> plisse::Result<Window> {
    context.egui_ctx.set_theme(egui::Theme::Light);
    files::notify(context.egui_ctx.clone());
    let (graphics, name) = graphics(context);
    let keep = driver.is_none().then(|| PathBuf::from(AUTOSAVES));
    let ctx = context.egui_ctx.clone();
    let mut studio = Studio::new(Start {
        graphics,
        autosave_folder: keep,
        request_repaint: Arc::new(move || ctx.request_repaint()),
    })?;
    studio.shell.messages.note(format!(
        "drawn by {}{}",
        name.split(':').next().unwrap_or_default(),
        why(&name, asked)
    ));
    if let Some(file) = asked.files.first() {
        studio.open(Path::new(file));
    }
    tell("running", &name);
    Ok(Window { studio, driver, failure: Arc::default() })
}

/// The reason why WebGL 2 draws, if it does.
fn why(name: &str, asked: &Asked) -> &'static str {
    let has_webgpu = call("has_webgpu", &[]).is_ok_and(|has| has.is_truthy());
    match (name.starts_with("WebGL"), asked.webgl, has_webgpu) {
        (false, ..) => "",
        (_, true, _) => ", as the page's address asks",
        (_, _, false) => "; this browser has no WebGPU",
        (_, _, true) => "; this browser's WebGPU gives no adapter",
    }
}

/// The page's adapter, and its name.
fn graphics(context: &eframe::CreationContext<'_>) -> (Graphics, String) {
    let Some(state) = context.wgpu_render_state.clone() else {
        return (Graphics::Processor, "the processor".into());
    };
    let info = state.adapter.get_info();
    let api = if info.backend == wgpu::Backend::Gl { "WebGL 2" } else { "WebGPU" };
    let whole = if info.name.is_empty() { api.to_owned() } else { format!("{api}: {}", info.name) };
    let soft = if info.name.contains("SwiftShader") { " (SwiftShader)" } else { "" };
    let gpu = Gpu::shared(state.device.clone(), state.queue.clone(), format!("{api}{soft}"));
    // A page has one thread.
    let (device, renderer) = (state.device, SendWrapper::new(state.renderer));
    let show: ShowTexture = Arc::new(move |view, there| {
        let mut renderer = renderer.write();
        match there {
            Some(id) => {
                renderer.update_egui_texture_from_wgpu_texture(
                    &device,
                    view,
                    wgpu::FilterMode::Linear,
                    id,
                );
                id
            }
            None => renderer.register_native_texture(&device, view, wgpu::FilterMode::Linear),
        }
    });
    (Graphics::Window(gpu, show), whole)
}

/// The program in a page.
struct PageWindow(Window);

impl eframe::App for PageWindow {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let was_driven = self.0.driver.is_some();
        self.0.frame(ui);
        after_frame(&mut self.0, was_driven);
        self.0.close_if_asked(ui.ctx());
    }
}

/// Does the page's work after a frame: opens files that arrived, and hands over files that were
/// written. `was_driven`: true if a script drove the frame.
fn after_frame(window: &mut Window, was_driven: bool) {
    if let Some(path) = open::first(&files::take()) {
        window.studio.shell.file_chooser = None;
        window.studio.ask_to_open(path.to_path_buf());
    }
    let written = disk::store().take_written();
    for path in written {
        let Ok(bytes) = disk::read(&path) else { continue };
        if path.starts_with(AUTOSAVES) {
            if call("keep", &[&String::from_utf8_lossy(&bytes).as_ref().into()]).is_err() {
                window.studio.shell.messages.problem(
                    "the autosave is too large for the browser's \
                    storage; save the document now and then",
                );
            }
        } else {
            let name = path
                .file_name()
                .map_or_else(|| "file".into(), |n| n.to_string_lossy().into_owned());
            if let Err(error) = call("download", &[&name.into(), &Uint8Array::from(&bytes[..])]) {
                window.studio.shell.messages.problem(format!(
                    "the browser did not take {}: {}; try again",
                    path.display(),
                    text_of(&error)
                ));
            }
        }
    }
    let keeps = disk::list(Path::new(AUTOSAVES)).is_ok_and(|files| {
        files.iter().any(|(name, _)| Path::new(AUTOSAVES).join(name) != Path::new(LEFTOVER))
    });
    if KEEPS.replace(keeps) && !keeps {
        // Storage that cannot be emptied costs a question at the next visit.
        let _ = call("forget", &[]);
    }
    let failure = window.failure.lock().ok().and_then(|mut f| f.take());
    if let Some(error) = failure {
        window.driver = None;
        tell("failed", &error.to_string());
    } else if was_driven && window.driver.is_none() {
        tell("done", "");
    }
    // A page is closed by its reader.
    window.studio.shell.quits = false;
}
