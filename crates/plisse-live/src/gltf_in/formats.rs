//! Files of other formats than glTF 2.0, recognised to be named for what they are.

use std::path::Path;

/// The way from other programs' files.
const BY_BLENDER: &str = "open it in Blender and export it as glTF 2.0 (.glb)";
/// The way from meshes that do not move.
const STILL: &str = "it holds no motion, so export the animated model as .glb, or wrinkle two of \
                     its poses with plisse wrinkle";

/// A sentence for a file that is no glTF 2.0 but can be told, by its first bytes or else by its
/// name: what it is and the way to go.
pub(super) fn other_format(bytes: &[u8], name: &str) -> Option<String> {
    let is_json = bytes.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{');
    if bytes.starts_with(b"glTF") {
        let version = bytes.get(4..8).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        return (version == Some(1)).then(gltf_1);
    }
    if is_json {
        return None;
    }
    let starts = |start: &[u8]| bytes.starts_with(start);
    let (format, way) = if starts(b"Kaydara FBX Binary") || starts(b"; FBX") {
        ("an FBX file", BY_BLENDER)
    } else if starts(b"Ogawa") || starts(b"\x89HDF") {
        ("an Alembic file", BY_BLENDER)
    } else if starts(b"PXR-USDC") || starts(b"#usda") {
        ("a USD file", BY_BLENDER)
    } else if starts(b"BLENDER") {
        ("a Blender file", BY_BLENDER)
    } else if starts(b"ply\n") || starts(b"ply\r") {
        ("a PLY file", STILL)
    } else if starts(b"\x1f\x8b") || starts(b"\x28\xb5\x2f\xfd") {
        ("a compressed file", "unpack it first")
    } else if starts(b"version https://git-lfs") {
        ("a pointer of Git LFS, not the file itself", "fetch it with git lfs pull")
    } else if starts(b"<!DOCTYPE html") || starts(b"<html") {
        ("a web page", "download the model itself")
    } else {
        by_extension(name, starts(b"PK\x03\x04"))?
    };
    Some(format!("this is {format}, which is not read; {way}"))
}

/// Format and way to go by the ending of a file's name.
fn by_extension(name: &str, is_zip: bool) -> Option<(&'static str, &'static str)> {
    let extension = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
    Some(match extension.as_str() {
        "fbx" => ("an FBX file", BY_BLENDER),
        "abc" => ("an Alembic file", BY_BLENDER),
        "usd" | "usda" | "usdc" | "usdz" => ("a USD file", BY_BLENDER),
        "blend" => ("a Blender file", BY_BLENDER),
        "dae" => ("a COLLADA file", BY_BLENDER),
        "x3d" | "wrl" => ("an X3D or VRML file", BY_BLENDER),
        "bvh" => ("a BVH file", BY_BLENDER),
        "3ds" | "max" | "ma" | "mb" | "c4d" | "lwo" => {
            ("another program's file", "export it there as glTF 2.0 (.glb)")
        }
        "obj" => ("an OBJ file", STILL),
        "ply" => ("a PLY file", STILL),
        "stl" => ("an STL file", STILL),
        _ if is_zip => ("a zip archive", "unpack it first"),
        _ => return None,
    })
}

/// The sentence about files of glTF 1.0.
pub(super) fn gltf_1() -> String {
    "this is glTF 1.0; convert it to 2.0 (gltf-pipeline does, or open and export it again)"
        .to_owned()
}
