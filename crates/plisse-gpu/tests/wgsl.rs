//! The WGSL of the host itself passes naga without a GPU. (That of the stages is checked in
//! `plisse-live`.)

use naga::valid::{Capabilities, ValidationFlags, Validator};

#[test]
fn all_wgsl_is_valid() {
    let mut files = 0;
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/src")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "wgsl") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let check = |text: &str| {
            let module = naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text))?;
            // No capability beyond what every WebGPU device has.
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .map_err(|e| e.emit_to_string(text))
        };
        check(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        check(&text.replacen("vec4f", "vec5f", 1)).expect_err("a perturbed text");
        files += 1;
    }
    assert_eq!(files, 2);
}
