//! URIs of a glTF file: other files, or bytes written into the URI.

use std::path::Path;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

/// Ordinary base64, with or without `=` at the end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The bytes that `uri` stands for: a file in `folder`, or base64 in the URI itself.
pub(super) fn load(uri: &str, folder: Option<&Path>) -> Option<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        return BASE64.decode(data.split_once(";base64,")?.1).ok();
    }
    // Some writers leave signs as they are that a URI must escape, also the escape sign itself.
    let plain = percent_decode_str(uri).decode_utf8().ok()?;
    let read = |name: &str| plisse::io::disk::read(folder?.join(name)).ok();
    read(&plain).or_else(|| read(uri))
}

/// The beginning of `uri`, for messages.
pub(super) fn short(uri: &str) -> String {
    uri.chars().take(40).collect()
}
