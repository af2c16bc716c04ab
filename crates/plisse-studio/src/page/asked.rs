//! The options in the page's address.

use plisse::{Error, Result};

/// The pairs after the "?" of the page's address.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Files to load from beside the page; the first one is opened.
    pub files: Vec<String>,
    /// A script to run, from beside the page.
    pub script: Option<String>,
    /// True if WebGL 2 is to draw even if there is WebGPU.
    pub webgl: bool,
}

impl Asked {
    /// Reads pairs of names and values.
    ///
    /// # Errors
    /// [`Error::Value`] naming an unknown pair.
    pub fn from_pairs(pairs: impl IntoIterator<Item = (String, String)>) -> Result<Self> {
        let mut asked = Self::default();
        for (name, value) in pairs {
            match (name.as_str(), value.as_str()) {
                ("file", _) => asked.files.push(value),
                ("script", _) => asked.script = Some(value),
                ("graphics", "webgl") => asked.webgl = true,
                ("graphics", "webgpu") => asked.webgl = false,
                _ => {
                    let fix = "give file=, script=, graphics=webgl or graphics=webgpu";
                    return Err(Error::value(
                        "page address",
                        format!("\"{name}={value}\" is unknown; {fix}"),
                    ));
                }
            }
        }
        Ok(asked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(pairs: &[(&str, &str)]) -> Result<Asked> {
        Asked::from_pairs(pairs.iter().map(|(n, v)| (n.to_string(), v.to_string())))
    }

    #[test]
    fn the_address_says_what_is_opened_and_run() {
        assert_eq!(asked(&[]).unwrap(), Asked::default());
        let all = asked(&[
            ("file", "a.toml"),
            ("file", "b.obj"),
            ("script", "s.txt"),
            ("graphics", "webgl"),
        ])
        .unwrap();
        assert_eq!(
            all,
            Asked {
                files: vec!["a.toml".into(), "b.obj".into()],
                script: Some("s.txt".into()),
                webgl: true
            }
        );
        assert!(!asked(&[("graphics", "webgpu")]).unwrap().webgl);
        for wrong in [("fiel", "a.obj"), ("graphics", "paper")] {
            let told = asked(&[wrong]).unwrap_err().to_string();
            assert!(told.contains(wrong.0) && told.contains(wrong.1), "{told}");
        }
    }
}
