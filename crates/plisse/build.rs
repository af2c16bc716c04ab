//! Sets `cfg(published_data)` where the published data lies beside the clone, so that tests that
//! need it are reported as ignored elsewhere. `plisse-live` and `plisse-gpu` use this script too.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(published_data)");
    // A path that does not exist would make every build run this again.
    println!("cargo::rerun-if-changed=build.rs");
    let data = std::path::Path::new("../../../shared/data");
    if data.is_dir() {
        println!("cargo::rustc-cfg=published_data");
        println!("cargo::rerun-if-changed={}", data.display());
    }
}
