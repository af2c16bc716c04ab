//! Commands and flags of the command line. Every help text names the unit and gives an example.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use plisse::field::WrinkleFreeRule;
use plisse::mesh::Up;

/// Puts wrinkles on coarse triangle meshes.
#[derive(Parser)]
#[command(
    name = "plisse",
    version,
    about = "Puts wrinkles and folds on coarse triangle meshes",
    after_help = "Example:\n  plisse solve examples/01-twisted-cylinder.toml -o out/cylinder\n\n\
        All quantities are in SI units: lengths in metres (m), Young's modulus in pascals (Pa)."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Bake wrinkles to height and normal maps (16-bit PNG) in the texture space of a model, a
    /// solved folder or a scene
    #[command(after_help = "Examples:\n  \
        plisse bake character.glb --wavelength 0.03 --clip walk --frames 48 -o out/walk\n  \
        plisse bake shirt --wavelength 0.05 --time 1 --size 1024\n  \
        plisse bake out/cylinder --map height\n\n\
        Writes normal.png and height.png (normal-0000.png and so on with --frames) and report.json \
        into DIR. Height: 0.5 is zero, white is the scale (m) that stands in report.json and in \
        the file. Normals: +Y up, as in glTF and OpenGL. Texture coordinates must lie within the \
        unit square. Ctrl-C stops and keeps the finished frames.")]
    Bake(BakeArguments),
    /// Grow the surface of a scene file and fold it up
    #[command(after_help = "Example:\n  plisse grow examples/20-small-folds.toml -o out/folds\n\n\
        Writes folded.obj, folded.glb, report.json and picture.png into DIR, and with --frames \
        frame-0000.obj (the start), frame-0001.obj and so on, one for each step. \
        docs/scene-format.md describes the table [growth] of a scene; lengths are in metres (m), \
        growth is a factor of length (no unit). Ctrl-C stops and writes the surface grown so far.")]
    Grow(GrowArguments),
    /// Wrinkle an animated model in real time: pictures, an animation, wrinkled geometry
    #[command(after_help = "Examples:\n  \
        plisse live character.glb --wavelength 0.03 --clip walk --frames 60 -o out/walk\n  \
        plisse live shirt --wavelength 0.05 --export out/shirt.glb\n  plisse live --bench\n\n\
        Writes frame-0000.png and so on, animation.png (an animated PNG) and report.json into DIR. \
        Runs on the GPU or on a software driver; with --cpu on the processor alone. Lengths are in \
        metres (m), angles in degrees, times in seconds (s). Ctrl-C stops and keeps the finished \
        frames.")]
    Live(LiveArguments),
    /// Solve a scene file: panels, material and clamps in, a wrinkled surface out
    #[command(after_help = "Example:\n  \
        plisse solve examples/01-twisted-cylinder.toml -o out/cylinder\n\n\
        Writes base.obj, wrinkled.obj, wrinkled.glb, field.json, report.json and picture.png into \
        DIR. docs/scene-format.md describes scene files; lengths are in metres (m), Young's \
        modulus in pascals (Pa), angles in degrees. Ctrl-C stops and writes the best state so \
        far.")]
    Solve(SolveArguments),
    /// Solve a scene file by a full shell on a fine mesh, to compare with: slow, and right only
    /// where the mesh resolves the wrinkles
    #[command(after_help = "Example:\n  \
        plisse shell examples/01-twisted-cylinder.toml --finer 3 -o out/cylinder-shell\n\n\
        Writes base.obj (the start), shell.obj, shell.glb, report.json and picture.png into DIR. \
        St. Venant-Kirchhoff membrane and mid-edge bending, full Newton. Lengths are in metres \
        (m). Ctrl-C stops and writes the best state so far.")]
    Shell(ShellArguments),
    /// Print the tables of Chen et al. 2021 beside the figures of this program
    #[command(after_help = "Example:\n  plisse study ablation -o out/study\n\n\
        Writes NAME.md, NAME.json and pictures into DIR; 'all' also writes validation.md. The \
        scenes are built in, so studies run anywhere. Units are in the titles of the columns. \
        Ctrl-C stops and writes the finished rows.")]
    Study(StudyArguments),
    /// Put wrinkles on a pose made elsewhere, given its rest shape
    #[command(after_help = "Example:\n  \
        plisse wrinkle --rest rest.obj --pose pose.obj --young 1e7 --poisson 0.44 \
        --thickness 1e-4\n\n\
        Rest and pose have the same faces in the same order; the rest shape may have more vertices \
        (panels, seams). Meshes are in metres (m). Writes base.obj, wrinkled.obj, wrinkled.glb, \
        field.json, report.json and picture.png into DIR.")]
    Wrinkle(WrinkleArguments),
}

/// Flags that all commands with results share.
#[derive(Args)]
pub(crate) struct OutputArguments {
    /// Folder for the results [default: out/NAME, after the input file]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Subdivision steps of the wrinkled surface (each makes four faces of one), 0 to 8 [default:
    /// enough for 8 edges a wave]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=8))]
    pub(crate) levels: Option<u32>,
    /// Threads to use [default: one for each core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
    /// Do not draw picture.png
    #[arg(long)]
    pub(crate) no_picture: bool,
    /// Energy terms or corrections to leave out, for comparisons: stretching, curvature, mixed,
    /// amplitude-gradient, bending, v1, v2, relaxed-integrability
    #[arg(long, value_name = "TERM", value_delimiter = ',')]
    pub(crate) without: Vec<String>,
}

#[derive(Args)]
pub(crate) struct BakeArguments {
    /// A model (.glb, .gltf, or square, curtain, zeppelin, shirt, sleeve), a folder that solve
    /// wrote, or a scene (.toml)
    #[arg(value_name = "INPUT")]
    pub(crate) input: String,
    /// Maps to bake
    #[arg(long, value_enum, default_value_t = Map::Both)]
    pub(crate) map: Map,
    /// Width and height of the maps (texels)
    #[arg(
        long,
        value_name = "N",
        default_value_t = 2048,
        value_parser = clap::value_parser!(u32).range(1..=16384)
    )]
    pub(crate) size: u32,
    /// Padding around islands (texels)
    #[arg(
        long,
        value_name = "N",
        default_value_t = 8,
        value_parser = clap::value_parser!(u32).range(0..=256)
    )]
    pub(crate) padding: u32,
    /// Folder for the maps [default: out/NAME/maps, after the input]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Time within the clip (s) of a single frame [default: 0]
    #[arg(long, value_name = "S", allow_hyphen_values = true, conflicts_with = "frames")]
    pub(crate) time: Option<f64>,
    /// Frames of a sequence over the whole clip
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: Option<u32>,
    #[command(flatten)]
    pub(crate) waves: WaveArguments,
    /// Threads to use [default: one for each core]; the maps do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
}

/// Wrinkles of an animated model.
#[derive(Args)]
pub(crate) struct WaveArguments {
    /// Width of one wrinkle in the rest pose (m); vertex colours (red, 0 to 1) may make it shorter
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) wavelength: Option<f64>,
    /// Shares (0 to 1) of the wavelength as a PNG, read through the texture coordinates
    #[arg(long, value_name = "FILE.png")]
    pub(crate) wavelength_map: Option<PathBuf>,
    /// Shape of the wrinkles: sine, accordion, pencil, or a text file with heights (-1 to 1) from
    /// crest to trough [default: sine]
    #[arg(long, value_name = "P", allow_hyphen_values = true)]
    pub(crate) profile: Option<String>,
    /// Animation to play [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,
    /// Scene of the file to read, by name or number [default: the file's own default]
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// Rounds of relaxation a frame [default: 1]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) rounds: Option<u32>,
    /// Leave the phases random instead of aligning them: irregular, like skin
    #[arg(long, conflicts_with = "rounds")]
    pub(crate) unrelaxed: bool,
    /// Wrinkles move with every n-th frame only [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) every: Option<u32>,
    /// Painted wrinkles of the rest pose: a JSON file {"bias": [[x, y, z], ...]}, one vector
    /// (shorter than 1) for each welded vertex
    #[arg(long, value_name = "FILE.json", conflicts_with = "random_wrinkles")]
    pub(crate) bias: Option<PathBuf>,
    /// Random wrinkles of the rest pose, 0 to 0.95
    #[arg(long, value_name = "AMOUNT", allow_hyphen_values = true)]
    pub(crate) random_wrinkles: Option<f64>,
    /// Chooses the random numbers [default: 1]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
}

impl WaveArguments {
    /// First of these flags that was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let flags = [
            ("--wavelength", self.wavelength.is_some()),
            ("--wavelength-map", self.wavelength_map.is_some()),
            ("--profile", self.profile.is_some()),
            ("--clip", self.clip.is_some()),
            ("--scene", self.scene.is_some()),
            ("--rounds", self.rounds.is_some()),
            ("--unrelaxed", self.unrelaxed),
            ("--every", self.every.is_some()),
            ("--bias", self.bias.is_some()),
            ("--random-wrinkles", self.random_wrinkles.is_some()),
            ("--seed", self.seed.is_some()),
        ];
        flags.iter().find(|(_, given)| *given).map(|(name, _)| *name)
    }
}

#[derive(Args)]
pub(crate) struct LiveArguments {
    /// A model: a .glb or .gltf file, or square, curtain, zeppelin, shirt, sleeve
    #[arg(value_name = "MODEL", required_unless_present = "bench")]
    pub(crate) model: Option<String>,
    #[command(flatten)]
    pub(crate) waves: WaveArguments,
    /// Frames to make [default: those of the whole clip, 240 at most]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: Option<u32>,
    /// Frames a second
    #[arg(long, value_name = "FPS", default_value_t = 60.0, allow_hyphen_values = true)]
    pub(crate) fps: f64,
    /// Time within the clip of the first frame (s); the frames before it are run through
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) start: f64,
    /// Size of the pictures (pixels)
    #[arg(long, value_name = "WxH", default_value = "960x720")]
    pub(crate) size: String,
    /// Camera position: degrees to the right of the model's front (+z)
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0, allow_hyphen_values = true)]
    pub(crate) yaw: f64,
    /// Camera position: degrees above the horizon
    #[arg(long, value_name = "DEGREES", default_value_t = 12.0, allow_hyphen_values = true)]
    pub(crate) pitch: f64,
    /// Image to draw the model with (PNG or JPEG) instead of its own
    #[arg(long, value_name = "FILE")]
    pub(crate) texture: Option<PathBuf>,
    /// Keep the texture in place instead of shifting it with the wrinkles
    #[arg(long)]
    pub(crate) no_parallax: bool,
    /// Run the stages on the processor instead of the GPU
    #[arg(long)]
    pub(crate) cpu: bool,
    /// Also write wrinkled geometry: of the single frame, or with more frames a morph-target
    /// animation
    #[arg(long, value_name = "FILE.glb")]
    pub(crate) export: Option<PathBuf>,
    /// Parts of every edge in --export, 1 to 64 [default: enough for 6 a wave]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) parts: Option<u32>,
    /// Measure milliseconds per stage on the paper's two cases and on 10k, 100k and 1M vertices
    /// instead
    #[arg(long, conflicts_with_all = ["model", "export", "frames"])]
    pub(crate) bench: bool,
    /// Folder for the results [default: out/NAME/live, after the model]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Threads to use [default: one for each core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
}

/// Maps that `plisse bake` writes.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Map {
    /// normal.png
    Normal,
    /// height.png
    Height,
    /// Both of them
    Both,
}

#[derive(Args)]
pub(crate) struct SolveArguments {
    /// The scene file
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

#[derive(Args)]
pub(crate) struct GrowArguments {
    /// The scene file, with a table [growth]
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/NAME, after the input file]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Least number of growth steps [default: that of the scene, or as many as folds need]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) steps: Option<u32>,
    /// Method that finds folds [default: that of the scene, or variational]
    #[arg(long, value_enum, value_name = "MODE")]
    pub(crate) mode: Option<GrowthMode>,
    /// Also write the surface after each step, as a mesh and as a picture (no pictures with
    /// --no-picture)
    #[arg(long)]
    pub(crate) frames: bool,
    /// Threads to use [default: one for each core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
    /// Do not draw picture.png
    #[arg(long)]
    pub(crate) no_picture: bool,
}

/// Methods that find folds.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum GrowthMode {
    /// By the least energy of a film on a foundation
    Variational,
    /// By the forces of Combaz & Neyret 2002
    Reference,
}

#[derive(Args)]
pub(crate) struct ShellArguments {
    /// The scene file
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: out/NAME, after the input file]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Divides the edge length of every panel (no unit): 2 makes four times as many faces
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) finer: f64,
    /// Start of the solve
    #[arg(long, value_enum, default_value_t = Start::Base)]
    pub(crate) start: Start,
    /// Random roughness of the start, in thicknesses, so that a flat sheet can buckle at all
    #[arg(long, value_name = "H", default_value_t = 0.1)]
    pub(crate) imperfection: f64,
    /// Maximum number of Newton iterations
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1000,
        value_parser = clap::value_parser!(u32).range(1..=1_000_000)
    )]
    pub(crate) iterations: u32,
    /// Threads to use [default: one for each core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
    /// Do not draw picture.png
    #[arg(long)]
    pub(crate) no_picture: bool,
}

/// Starts of `plisse shell`.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Start {
    /// The tension-field base surface on the same mesh
    Base,
    /// The panels as the scene places them
    Flat,
}

#[derive(Args)]
pub(crate) struct WrinkleArguments {
    /// Rest shape (OBJ, metres): flat panels or any mesh without strain
    #[arg(long, value_name = "R.obj")]
    pub(crate) rest: PathBuf,
    /// Pose (OBJ, metres), free of wrinkles, with the same faces
    #[arg(long, value_name = "P.obj")]
    pub(crate) pose: PathBuf,
    /// Young's modulus (Pa)
    #[arg(long, value_name = "PA", allow_hyphen_values = true)]
    pub(crate) young: f64,
    /// Poisson's ratio (no unit), above -1 and at most 0.5
    #[arg(long, value_name = "NU", allow_hyphen_values = true)]
    pub(crate) poisson: f64,
    /// Thickness (m)
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) thickness: f64,
    /// Vertices without wrinkles: one index (from 0) a line, or lines `index x y z`
    #[arg(long, value_name = "FILE")]
    pub(crate) clamp: Option<PathBuf>,
    /// Axis of the meshes that points up, for the picture and for wrinkled.glb
    #[arg(long, value_parser = up(), default_value = "y")]
    pub(crate) up: Up,
    /// Rule for wrinkle-free faces
    #[arg(long, value_enum, default_value_t = Rule::Paper)]
    pub(crate) wrinkle_free: Rule,
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}

#[derive(Args)]
pub(crate) struct StudyArguments {
    /// The study
    #[arg(value_enum, value_name = "NAME")]
    pub(crate) name: StudyName,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR", default_value = "out/study")]
    pub(crate) output: PathBuf,
    /// Solve a few small meshes, to see within a minute that everything runs; the figures mean
    /// little
    #[arg(long)]
    pub(crate) quick: bool,
    /// Maximum number of vertices of a reference shell; finer ones are left out (13,000 take
    /// minutes each, 100,000 hours)
    #[arg(
        long,
        value_name = "N",
        default_value_t = 13_000,
        value_parser = clap::value_parser!(u32).range(100..=1_000_000)
    )]
    pub(crate) shell_limit_vertices: u32,
    /// Scenes of 'timing', by the numbers that their files begin with, such as 3,9 [default: all]
    #[arg(
        long,
        value_name = "N,N",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u8).range(1..=11)
    )]
    pub(crate) scenes: Vec<u8>,
    /// Folder with published meshes and solutions (tfw-disk, cylinder-688) for a further table of
    /// 'timing'
    #[arg(long, value_name = "FOLDER")]
    pub(crate) data: Option<PathBuf>,
    /// Threads to use [default: one for each core]; only the seconds depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) threads: Option<u32>,
}

/// Names of the studies.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum StudyName {
    /// Vertices, iterations and seconds for base, field and reference shell, per scene (tables 1
    /// and 2)
    Timing,
    /// Dependence on the number of vertices (figures 7, 20 and 21)
    Resolution,
    /// Dependence on the structure of the mesh (section 6.3, figure 18)
    Meshing,
    /// Effect of each term and correction (figures 4 and 5)
    Ablation,
    /// A scaling law instead of the solve (figures 8 and 10)
    ScalingLaw,
    /// Folds of a square that grows: number, coherence, both modes (docs/growth.md)
    Growth,
    /// All of them but growth, and validation.md
    All,
}

/// The parser of `--up`.
fn up() -> impl TypedValueParser<Value = Up> {
    PossibleValuesParser::new([
        PossibleValue::new("y").help("As most programs export OBJ, and as glTF has it"),
        PossibleValue::new("z").help("As scene files have it"),
    ])
    .map(|name| if name == "y" { Up::Y } else { Up::Z })
}

/// Names of the rules for wrinkle-free faces.
#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Rule {
    /// Section 5.1 of Chen et al. 2021
    Paper,
    /// That of the published code of Chen et al. 2021
    Published,
}

impl From<Rule> for WrinkleFreeRule {
    fn from(rule: Rule) -> Self {
        match rule {
            Rule::Paper => Self::Paper,
            Rule::Published => Self::Published,
        }
    }
}
