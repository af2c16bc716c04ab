//! The functions of the page's own script (`web/index.html`).

use js_sys::{Array, Function, Promise, Reflect};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;

/// Calls a function of the page's script.
pub(crate) fn call(name: &str, arguments: &[&JsValue]) -> Result<JsValue, JsValue> {
    let script = Reflect::get(&js_sys::global(), &"plisse".into())?;
    let function: Function = Reflect::get(&script, &name.into())?.dyn_into()?;
    function.apply(&script, &arguments.iter().copied().collect::<Array>())
}

/// As [`call`], for functions that return promises.
pub(crate) async fn call_and_wait(name: &str, arguments: &[&JsValue]) -> Result<JsValue, JsValue> {
    JsFuture::from(call(name, arguments)?.dyn_into::<Promise>()?).await
}

/// Tells the page the state of the program: "running" (with the adapter's name), "done" (its script
/// has ended), or "failed" (with the reason).
pub(crate) fn tell(state: &str, text: &str) {
    // A page without this function needs no news.
    let _ = call("tell", &[&state.into(), &text.into()]);
}

/// The text of a value or an error.
pub(crate) fn text_of(value: &JsValue) -> String {
    value
        .as_string()
        .or_else(|| value.dyn_ref::<js_sys::Error>().map(|e| String::from(e.message())))
        .unwrap_or_else(|| format!("{value:?}"))
}

/// Runs `work` after the next frames, so that the page shows first what is being done.
pub(crate) fn later(work: impl FnOnce() + 'static) {
    let work = Closure::once_into_js(work);
    if call("later", &[&work]).is_err() {
        // Without the page's clock: at once.
        let _ = work.unchecked_into::<Function>().call0(&JsValue::NULL);
    }
}
