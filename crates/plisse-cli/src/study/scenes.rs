//! The scenes of `examples/` that `plisse solve` takes, built in so that studies run anywhere.

use plisse::Result;
use plisse::scene::{Scene, parse};

/// File name and text of every scene below 20, in the order of their numbers; from there on scenes
/// grow, and no study has them.
const SCENES: [(&str, &str); 11] = [
    ("01-twisted-cylinder.toml", include_str!("../../../../examples/01-twisted-cylinder.toml")),
    ("02-stretched-sheet.toml", include_str!("../../../../examples/02-stretched-sheet.toml")),
    ("03-sheared-rectangle.toml", include_str!("../../../../examples/03-sheared-rectangle.toml")),
    ("04-sphere-drape.toml", include_str!("../../../../examples/04-sphere-drape.toml")),
    ("05-dress.toml", include_str!("../../../../examples/05-dress.toml")),
    ("06-trousers.toml", include_str!("../../../../examples/06-trousers.toml")),
    ("07-torus.toml", include_str!("../../../../examples/07-torus.toml")),
    ("08-balloon.toml", include_str!("../../../../examples/08-balloon.toml")),
    ("09-teabag.toml", include_str!("../../../../examples/09-teabag.toml")),
    ("10-bear.toml", include_str!("../../../../examples/10-bear.toml")),
    ("11-curtain.toml", include_str!("../../../../examples/11-curtain.toml")),
];

/// The scene whose file begins with this number, if there is one.
pub(crate) fn numbered(number: usize) -> Result<Option<Scene>> {
    let prefix = format!("{number:02}-");
    SCENES
        .iter()
        .find(|(name, _)| name.starts_with(&prefix))
        .map(|(name, text)| parse(name, text))
        .transpose()
}

/// The scene whose file begins with this number, which is one of the first three.
pub(crate) fn first_three(number: usize) -> Result<Scene> {
    Ok(numbered(number)?.expect("scenes 01 to 03 are built in"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_is_built_in_and_can_be_read() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
        let files = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut there: Vec<String> =
            files.filter(|name| name.ends_with(".toml") && name.as_str() < "20").collect();
        there.sort();
        assert_eq!(SCENES.map(|(name, _)| name.to_owned()).to_vec(), there);
        for number in 1..=SCENES.len() {
            numbered(number).unwrap();
        }
    }
}
