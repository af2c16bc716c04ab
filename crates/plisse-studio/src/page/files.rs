//! Files that the reader chooses or drops on the page.

use std::cell::RefCell;
use std::path::PathBuf;

use js_sys::{Array, Uint8Array};
use plisse::io::disk;
use wasm_bindgen_futures::spawn_local;

use super::bindings::{call_and_wait, text_of};

thread_local! {
    static ARRIVALS: RefCell<Arrivals> = RefCell::default();
}

/// Files that have arrived, and the window that is to open them.
#[derive(Default)]
struct Arrivals {
    paths: Vec<PathBuf>,
    ctx: Option<egui::Context>,
}

/// Requests a frame of the window `ctx` when files arrive.
pub(crate) fn notify(ctx: egui::Context) {
    ARRIVALS.with_borrow_mut(|arrivals| arrivals.ctx = Some(ctx));
}

/// The files that arrived since the last call.
pub(crate) fn take() -> Vec<PathBuf> {
    ARRIVALS.with_borrow_mut(|arrivals| std::mem::take(&mut arrivals.paths))
}

/// Lets the reader choose files, which are opened once they are read.
pub(crate) fn choose() {
    spawn_local(async {
        let Ok(files) = call_and_wait("choose", &[]).await else { return };
        let mut paths = Vec::new();
        for file in Array::from(&files) {
            let pair: Array = file.into();
            let path = PathBuf::from(text_of(&pair.get(0)));
            disk::store().put(&path, Uint8Array::new(&pair.get(1)).to_vec());
            paths.push(path);
        }
        arrive(paths);
    });
}

/// Reads files that were dropped, which are then opened.
pub(crate) fn read_dropped(files: Vec<egui::DroppedFileHandle>) {
    spawn_local(async move {
        let mut paths = Vec::new();
        for file in files {
            if let Ok(bytes) = file.bytes_async().await {
                disk::store().put(file.path(), bytes);
                paths.push(file.path().to_path_buf());
            }
        }
        arrive(paths);
    });
}

fn arrive(paths: Vec<PathBuf>) {
    ARRIVALS.with_borrow_mut(|arrivals| {
        arrivals.paths.extend(paths);
        if let Some(ctx) = &arrivals.ctx {
            ctx.request_repaint();
        }
    });
}
