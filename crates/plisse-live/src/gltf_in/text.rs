//! The JSON text of a glTF file: exporters write names in any bytes.

use serde_json::Value;

/// JSON of `bytes`, and a note if the text had to be repaired: bytes that are no UTF-8 are read as
/// Latin-1; control characters, unknown escapes and halves of surrogate pairs in strings stand for
/// themselves; a byte order mark and zeros at the end are passed over.
///
/// # Errors
/// That of the parser, if the text is no JSON even so.
pub(super) fn parse(bytes: &[u8]) -> Result<(Value, Option<String>), serde_json::Error> {
    let error = match serde_json::from_slice(bytes) {
        Ok(value) => return Ok((value, None)),
        Err(error) => error,
    };
    let (text, place) = repaired(bytes);
    let value = serde_json::from_str(&text).map_err(|_| error)?;
    let note = place.map(|byte| {
        format!(
            "the file's text breaks the rules of JSON (first at its byte {byte}, in a name or \
             another string); it was read as Latin-1"
        )
    });
    Ok((value, note))
}

/// `bytes` as text that a parser takes, and the first byte in a string that was changed.
fn repaired(bytes: &[u8]) -> (String, Option<usize>) {
    let start = if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
    let end = bytes.iter().rposition(|&b| b != 0).map_or(0, |last| last + 1).max(start);
    let bytes = &bytes[..end];
    let (mut text, mut first, mut is_string, mut at) = (String::new(), None, false, start);
    while at < bytes.len() {
        let (part, length, is_sound) = match bytes[at] {
            b'\\' if is_string => escape(&bytes[at..]),
            b @ 0..0x20 if is_string => (format!("\\u{b:04x}"), 1, false),
            b @ 0x80.. => character(&bytes[at..]).map_or_else(
                || (char::from(b).to_string(), 1, false),
                |c| (c.to_string(), c.len_utf8(), true),
            ),
            b => {
                is_string ^= b == b'"';
                (char::from(b).to_string(), 1, true)
            }
        };
        if !is_sound {
            first.get_or_insert(at);
        }
        text += &part;
        at += length;
    }
    (text, first)
}

/// The UTF-8 character at the beginning of `bytes`.
fn character(bytes: &[u8]) -> Option<char> {
    let most = bytes.len().min(4);
    let text = (1..=most).find_map(|n| std::str::from_utf8(&bytes[..n]).ok())?;
    text.chars().next()
}

/// The escape at the beginning of `bytes` as a parser takes it, its length in bytes, and true if
/// it was one.
fn escape(bytes: &[u8]) -> (String, usize, bool) {
    let code = |bytes: &[u8]| {
        let digits = bytes.strip_prefix(b"\\u")?.get(..4)?;
        let is_hex = digits.iter().all(u8::is_ascii_hexdigit);
        is_hex.then(|| u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok())?
    };
    let plain = |length: usize| String::from_utf8_lossy(&bytes[..length]).into_owned();
    match (bytes.get(1), code(bytes)) {
        (Some(b'"' | b'\\' | b'/' | b'b' | b'f' | b'n' | b'r' | b't'), _) => (plain(2), 2, true),
        (_, Some(0xD800..0xDC00))
            if code(&bytes[6..]).is_some_and(|low| (0xDC00..0xE000).contains(&low)) =>
        {
            (plain(12), 12, true)
        }
        (_, Some(0xD800..0xE000)) => ("\\ufffd".to_owned(), 6, false),
        (_, Some(_)) => (plain(6), 6, true),
        _ => ("\\\\".to_owned(), 1, false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_any_bytes_are_read() {
        for (text, name, place) in [
            (&b"{\"name\": \"M\xE9\"}"[..], "M\u{e9}", Some(11)),
            (b"{\"name\": \"M\xC3\xA9\"}", "M\u{e9}", None),
            (b"{\"name\": \"a\nb\0\"}", "a\nb\0", Some(11)),
            (b"{\"name\": \"C:\\models\"}", "C:\\models", Some(12)),
            (b"{\"name\": \"\\ud83dx\"}", "\u{fffd}x", Some(10)),
            (b"{\"name\": \"\\ud83d\\ude00\xFF\"}", "\u{1f600}\u{ff}", Some(22)),
            (b"\xEF\xBB\xBF{\"name\": \"a\"}\0\0\0", "a", None),
        ] {
            let (value, note) = parse(text).unwrap();
            assert_eq!(value["name"], name);
            let note = note.unwrap_or_default();
            let told = place.map(|p| format!("its byte {p},"));
            assert_eq!(!note.is_empty(), told.is_some(), "{note}");
            assert!(note.contains(&told.unwrap_or_default()), "{note}");
        }
        for text in
            [&b""[..], b"\0", b"{\"name", b"{\"name\": \"\\", b"{\"name\": \"\\ud83d", b"\xFF"]
        {
            assert!(parse(text).is_err());
        }
    }
}
