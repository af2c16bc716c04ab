//! Rust source as the architecture test reads it: the paths a file imports, without comments,
//! strings and what is compiled for tests only.

use std::path::{Path, PathBuf};

/// A source file, ready to be searched.
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    /// Module path from the crate's root, such as `["field", "solve"]`; empty for the root.
    pub(crate) modules: Vec<String>,
    /// Text with comments, strings and test items blanked.
    pub(crate) code: String,
}

/// Sources below `folder` (a crate's `src`), except files of test modules, in the order of their
/// paths.
pub(crate) fn sources(folder: &Path) -> Vec<Source> {
    let mut list = Vec::new();
    collect(folder, &[], &mut list);
    list
}

fn collect(folder: &Path, modules: &[String], list: &mut Vec<Source>) {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let is_rust = |path: &&PathBuf| path.extension().is_some_and(|e| e == "rs");
    let mut tests = Vec::new();
    let mut found = Vec::new();
    for path in paths.iter().filter(is_rust) {
        let text = std::fs::read_to_string(path).unwrap();
        let (code, test_modules) = without_tests(&blanked(&text));
        // Modules of `a.rs` lie in `a/`, those of `mod.rs` and of the root beside it.
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let own = if matches!(&stem[..], "mod" | "lib" | "main") { None } else { Some(stem) };
        let modules: Vec<String> = modules.iter().cloned().chain(own).collect();
        tests.extend(test_modules.into_iter().map(|name| [&modules[..], &[name]].concat()));
        found.push(Source { path: path.clone(), modules, code });
    }
    list.extend(found.into_iter().filter(|s| !tests.contains(&s.modules)));
    for path in paths.iter().filter(|path| path.is_dir()) {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let modules: Vec<String> = modules.iter().cloned().chain([name]).collect();
        if !tests.contains(&modules) {
            collect(path, &modules, list);
        }
    }
}

/// Rust source with comments, strings and characters replaced by blanks.
pub(crate) fn blanked(text: &str) -> String {
    let source: Vec<char> = text.chars().collect();
    let mut out = String::new();
    let mut i = 0;
    while i < source.len() {
        let end = skipped(&source, i);
        if end == i {
            out.push(source[i]);
            i += 1;
        } else {
            out.extend(source[i..end].iter().map(|&c| if c == '\n' { c } else { ' ' }));
            i = end;
        }
    }
    out
}

/// End of the comment, string or character that begins at `i`; `i` if there is none.
fn skipped(source: &[char], i: usize) -> usize {
    let starts = |at: usize, word: &str| {
        word.chars().enumerate().all(|(k, c)| source.get(at + k) == Some(&c))
    };
    let find = |from: usize, word: &str| {
        (from..source.len()).find(|&at| starts(at, word)).map_or(source.len(), |at| at + word.len())
    };
    let after_name = i > 0 && (source[i - 1].is_alphanumeric() || source[i - 1] == '_');
    if starts(i, "//") {
        return (i..source.len()).find(|&at| source[at] == '\n').unwrap_or(source.len());
    }
    if starts(i, "/*") {
        return find(i + 2, "*/");
    }
    if !after_name && (starts(i, "r\"") || starts(i, "r#") || starts(i, "br")) {
        let hashes_at = i + if source[i] == 'b' { 2 } else { 1 };
        let hashes = source[hashes_at..].iter().take_while(|&&c| c == '#').count();
        if starts(hashes_at + hashes, "\"") {
            return find(hashes_at + hashes + 1, &format!("\"{}", "#".repeat(hashes)));
        }
    }
    if starts(i, "\"") {
        let mut at = i + 1;
        while at < source.len() && source[at] != '"' {
            at += if source[at] == '\\' { 2 } else { 1 };
        }
        return at + 1;
    }
    // A character, not a lifetime.
    if starts(i, "'\\") {
        return find(i + 3, "'");
    }
    if starts(i, "'") && source.get(i + 2) == Some(&'\'') {
        return i + 3;
    }
    i
}

/// Blanked source without the items under `#[cfg(test)]`, and the names of the modules among them
/// that have files of their own.
pub(crate) fn without_tests(code: &str) -> (String, Vec<String>) {
    const MARK: &str = "#[cfg(test)]";
    let (mut out, mut modules) = (String::new(), Vec::new());
    let mut rest = code;
    while let Some(at) = rest.find(MARK) {
        out += &rest[..at];
        let item = &rest[at + MARK.len()..];
        let end = item_end(item);
        let mut words = item[..end].split(|c: char| !c.is_alphanumeric() && c != '_');
        if words.any(|word| word == "mod") && item[..end].ends_with(';') {
            modules.extend(words.find(|word| !word.is_empty()).map(str::to_owned));
        }
        rest = &item[end..];
    }
    (out + rest, modules)
}

/// Length of the first item of blanked source: up to its semicolon, or the brace that closes it.
fn item_end(item: &str) -> usize {
    let mut depth = 0;
    for (at, c) in item.char_indices() {
        match c {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth -= 1,
            _ => {}
        }
        if depth == 0 && (c == ';' || c == '}') {
            return at + 1;
        }
    }
    item.len()
}

impl Source {
    /// Top-level modules of its crate that the code names, by `crate::…`, by `crate::{…}` or by
    /// `super::` as far as the root.
    pub(crate) fn used(&self) -> Vec<String> {
        let mut used = Vec::new();
        for part in self.code.split("crate::").skip(1) {
            heads(part, &mut used);
        }
        let mut rest = &self.code[..];
        while let Some(at) = rest.find("super::") {
            let chain = &rest[at..];
            let supers = 1 + chain.split("super::").skip(1).take_while(|p| p.is_empty()).count();
            let after = &chain["super::".len() * supers..];
            if supers >= self.modules.len() && !self.modules.is_empty() {
                heads(after, &mut used);
            }
            rest = after;
        }
        used
    }
}

/// Adds the first names of the path or group at the beginning of `path`.
fn heads(path: &str, names: &mut Vec<String>) {
    let name = |text: &str| -> String {
        text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let Some(group) = path.strip_prefix('{') else {
        names.push(name(path));
        return;
    };
    let (mut depth, mut begin) = (0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                names.push(name(&group[begin..at]));
                return;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                names.push(name(&group[begin..at]));
                begin = at + 1;
            }
            _ => {}
        }
    }
}
