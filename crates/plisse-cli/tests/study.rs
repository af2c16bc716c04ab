//! `plisse study` from outside: it writes its files, and refuses what it cannot do before anything
//! long begins.

mod harness;

use harness::{Folder, assert_refused, json, names, plisse};

#[test]
fn a_quick_study_writes_text_data_and_pictures() {
    let folder = Folder::new("study");
    let out = folder.0.join("out");
    let output = plisse().args(["study", "ablation", "--quick", "-o"]).arg(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let files = names(&out);
    for name in ["ablation-cylinder.png", "ablation.json", "ablation.md"] {
        assert!(files.iter().any(|file| file == name), "{name} is not in {files:?}");
        assert!(std::fs::metadata(out.join(name)).unwrap().len() > 100, "{name}");
    }
    let data = json(&out.join("ablation.json"));
    assert_eq!(data["complete"], true);
    let rows = data["tables"][0]["rows"].as_array().unwrap();
    let waves = |left_out: &str| {
        rows.iter().find(|row| row["left out"] == left_out).unwrap()["waves before rounding"]
            .as_f64()
            .unwrap()
    };
    assert!((38.0..50.0).contains(&waves("nothing")), "{}", waves("nothing"));
    assert!(waves("v1") > 180.0, "{}", waves("v1"));
    let text = std::fs::read_to_string(out.join("ablation.md")).unwrap();
    let shown = String::from_utf8_lossy(&output.stdout);
    for part in ["| v1 |", "> 180", "(ablation-cylinder.png)"] {
        assert!(text.contains(part) && shown.contains(part), "{part}");
    }
    assert!(text.contains("Written by `plisse study ablation --quick"), "{text}");
}

#[test]
fn unknown_studies_and_unwritable_folders_are_told() {
    let folder = Folder::new("study-refused");
    let output = plisse().args(["study", "everything"]).current_dir(&folder.0).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("everything") && text.contains("scaling-law"), "{text}");
    let file = folder.write("file", "in the way");
    let out = file.join("out");
    let output = plisse().args(["study", "ablation", "--quick", "-o"]).arg(&out).output().unwrap();
    assert_refused(&output, &out, &["file"]);
    assert_eq!(names(&folder.0), ["file"]);
}
