//! One picture of one result: base surface, amplitude, phase and wrinkled surface, side by side and
//! from the same side, like figure 5 of [Chen 2021]. Drawn on the processor, so that a picture
//! needs neither a graphics card nor a display.
//!
//! Limits: orthographic views only, opaque surfaces, no cast shadows, fewer than 2³² − 1 faces,
//! Latin-1 lettering. `euc` is not used: it decides coverage with an inverted single-precision
//! matrix per triangle, which leaves holes between thin neighbours, asserts on degenerate triangles
//! and runs on one thread; see `raster.rs` for the exact replacement.
//!
//! The same input gives the same bytes for any number of threads: threads own whole bands of rows,
//! and every sum that crosses a band is taken in row order.

mod camera;
mod colour;
#[cfg(test)]
mod gallery;
mod image;
mod lettering;
mod paint;
mod raster;
mod relief;

pub use camera::Camera;
pub use colour::CLOTH;
pub use image::{Image, write_png};

use crate::mesh::Vec3;
use camera::Frame;
use lettering::{Align, INK, QUIET};
use paint::{Painted, Surface};
use rayon::prelude::*;

/// The surface to draw. A face that names a missing vertex, or one with a coordinate that is not
/// finite, is left out.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// `[V]` position of each vertex (m).
    pub positions: &'a [Vec3],
    /// `[F][3]` vertices of each face. The order does not matter: both sides are lit.
    pub faces: &'a [[usize; 3]],
}

/// The colours of a [`Subject`].
#[derive(Clone, Copy, Debug)]
pub enum Paint<'a> {
    /// One lit colour.
    Plain {
        /// sRGB colour of the material, 0–255.
        colour: [u8; 3],
        /// `true`: facets with their visible edges drawn on top, for a coarse mesh. `false`:
        /// smooth, with smooth normals.
        ///
        /// A smooth surface whose relief is too shallow to see has its slopes steepened *for the
        /// light only* (at most fivefold; the factor is written under the panel). The drawn shape
        /// is never exaggerated.
        wireframe: bool,
    },
    /// A number per vertex, by the viridis colours from 0 to `maximum`, with a colour bar. Grey
    /// where there is no finite number.
    Scalar {
        /// `[V]` value at each vertex, in `unit`; linear inside a face.
        values: &'a [f64],
        /// The value of the last colour, in `unit`; a value that is not positive and finite counts
        /// as 1.
        maximum: f64,
        /// Unit of `values` and `maximum`, as written beside the colour bar (e.g. "mm").
        unit: &'a str,
    },
    /// A phase by a cyclic colour: light yellow on crests (0), dark blue in troughs (π), red and
    /// green on the flanks.
    Phase {
        /// `[F][3]` phase at each corner of each face (rad), linear inside the face, so one face
        /// may carry many waves. A face with a corner that is not finite carries no wrinkle and is
        /// black.
        corners: &'a [[f64; 3]],
    },
}

/// One of the four panels.
#[derive(Clone, Copy, Debug)]
pub struct PanelView<'a> {
    /// Written above the panel; shortened when it is wider than the panel.
    pub title: &'a str,
    /// The surface to draw.
    pub subject: Subject<'a>,
    /// Its colours.
    pub paint: Paint<'a>,
}

/// Draws four panels, read row by row, at one common scale from one common `camera`.
///
/// The frame holds every subject: where one reaches beyond what the camera was fitted to, the scale
/// shrinks. The panels stand 2×2; very elongated subjects get one column or one row instead. `size`
/// is width and height (pixels); 1600×1200 is a good one, and lettering grows with it.
pub fn draw(panels: &[PanelView; 4], camera: &Camera, size: (usize, usize)) -> Image {
    draw_among(panels, Subject { positions: &[], faces: &[] }, camera, size)
}

/// As [`draw`], with plain grey `bodies` around and inside the subjects. They do not change the
/// frame, so they may be cut off.
pub fn draw_among(
    panels: &[PanelView; 4],
    bodies: Subject,
    camera: &Camera,
    size: (usize, usize),
) -> Image {
    let mut image = Image::blank(size.0, size.1);
    let bounds = panels
        .iter()
        .fold(camera.bounds(), |bounds, panel| bounds.including(camera, panel.subject));
    let letters = (size.0.min(size.1 * 4 / 3) / 1600).max(1);
    let (columns, viewport) = best_layout(size, letters, bounds.half_extent());
    let frame = Frame::new(camera, &bounds, viewport);
    // Panels often show one subject in several colours.
    let same = |a: &Subject, b: &Subject| {
        std::ptr::eq(a.positions, b.positions) && std::ptr::eq(a.faces, b.faces)
    };
    let mut subjects: Vec<Subject> = Vec::new();
    let shown = panels.each_ref().map(|panel| {
        subjects.iter().position(|subject| same(subject, &panel.subject)).unwrap_or_else(|| {
            subjects.push(panel.subject);
            subjects.len() - 1
        })
    });
    let surfaces: Vec<Surface> =
        subjects.par_iter().map(|&subject| Surface::new(subject, bodies, &frame)).collect();
    let painted: Vec<Painted> = panels
        .par_iter()
        .zip(&shown)
        .map(|(panel, &n)| paint::paint(panel.paint, &surfaces[n]))
        .collect();
    for (p, (panel, painted)) in panels.iter().zip(&painted).enumerate() {
        let cell = (size.0 / columns, size.1 / (4 / columns));
        let corner = ((p % columns) * cell.0, (p / columns) * cell.1);
        let place = Place { left: corner.0, top: corner.1, width: cell.0, height: cell.1, letters };
        image.paste(&painted.image, place.left + MARGIN * letters, place.top + HEAD * letters);
        annotate(&mut image, panel, painted, &frame, place);
    }
    image
}

/// One surface in several poses, on one mesh or several, a picture of each from the same `camera`
/// and at the same scale, with grey `bodies` around it; `size` is width and height (pixels). No
/// title and no key.
pub fn draw_frames(
    poses: &[Subject<'_>],
    paint: Paint,
    bodies: Subject,
    camera: &Camera,
    size: (usize, usize),
) -> Vec<Image> {
    let bounds = poses.iter().fold(camera.bounds(), |bounds, pose| bounds.including(camera, *pose));
    let view = (size.0.saturating_sub(2 * MARGIN), size.1.saturating_sub(2 * MARGIN));
    let frame = Frame::new(camera, &bounds, view);
    let one = |&subject: &Subject<'_>| {
        let mut image = Image::blank(size.0, size.1);
        let painted = paint::paint(paint, &Surface::new(subject, bodies, &frame));
        image.paste(&painted.image, MARGIN, MARGIN);
        image
    };
    poses.iter().map(one).collect()
}

/// Space left and right of a panel's view (pixels, at letter size 1).
const MARGIN: usize = 20;
/// Space above a panel's view, for the title.
const HEAD: usize = 48;
/// Space below a panel's view, for its key.
const FOOT: usize = 48;

/// The cell of one panel in the picture (pixels).
#[derive(Clone, Copy)]
struct Place {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    letters: usize,
}

/// Number of columns, and width and height of each view, that show a subject of this half extent
/// (m) largest. Two columns unless another number is better by a quarter.
fn best_layout(
    size: (usize, usize),
    letters: usize,
    half_extent: [f64; 2],
) -> (usize, (usize, usize)) {
    let view = |columns: usize| {
        let width = (size.0 / columns).saturating_sub(2 * MARGIN * letters);
        let height = (size.1 / (4 / columns)).saturating_sub((HEAD + FOOT) * letters);
        (width, height)
    };
    let scale = |columns: usize| {
        let (width, height) = view(columns);
        (width as f64 / half_extent[0]).min(height as f64 / half_extent[1])
    };
    let mut best = 2;
    for columns in [1, 4] {
        if scale(columns) > 1.25 * scale(2) && scale(columns) > scale(best) {
            best = columns;
        }
    }
    (best, view(best))
}

/// Writes title and key of a panel around its view.
fn annotate(image: &mut Image, panel: &PanelView, painted: &Painted, frame: &Frame, place: Place) {
    let s = place.letters;
    let middle = place.left + place.width / 2;
    let room = place.width.saturating_sub(2 * s);
    lettering::write(image, panel.title, (middle, place.top + 16 * s), Align::Centre, room, s, INK);
    let line = place.top + place.height.saturating_sub(36 * s);
    match panel.paint {
        Paint::Plain { .. } => {
            let mut room_left = place.width.saturating_sub(2 * MARGIN * s);
            let longest = room_left as f64 / frame.pixels_per_metre() / 4.0;
            if let Some((length, text)) = lettering::round_length(longest) {
                let pixels = (length * frame.pixels_per_metre()).round() as usize;
                let left = place.left + MARGIN * s;
                lettering::scale_bar(image, (left, line + 10 * s), pixels, s);
                lettering::write(
                    image,
                    &text,
                    (left + pixels + 10 * s, line),
                    Align::Left,
                    room,
                    s,
                    INK,
                );
                room_left = room_left.saturating_sub(pixels + 20 * s + lettering::width(&text, s));
            }
            let text = format!("light: slopes x {:.1}", painted.relief_gain);
            if painted.relief_gain > 1.05 && lettering::width(&text, s) <= room_left {
                let right = place.left + place.width.saturating_sub(MARGIN * s);
                lettering::write(image, &text, (right, line), Align::Right, room, s, QUIET);
            }
        }
        Paint::Scalar { maximum, unit, .. } => {
            let maximum = paint::usable_maximum(maximum);
            let label = format!("{} {unit}", lettering::three_digits(maximum));
            lettering::colour_bar(
                image,
                (middle, line),
                place.width,
                ["0", label.trim_end()],
                s,
                |t| colour::viridis(t as f32),
            );
        }
        Paint::Phase { .. } => {
            let right = lettering::colour_bar(
                image,
                (middle, line),
                place.width,
                ["0", "2 pi rad"],
                s,
                |t| {
                    let angle = t * std::f64::consts::TAU;
                    colour::cyclic(angle.cos() as f32, angle.sin() as f32)
                },
            );
            if painted.unwrinkled {
                lettering::swatch(image, (right + 24 * s, line), [0; 3], s);
                let room = (place.left + place.width).saturating_sub(right + 48 * s);
                lettering::write(
                    image,
                    "no wrinkle",
                    (right + 46 * s, line),
                    Align::Left,
                    room,
                    s,
                    INK,
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::gallery::{cylinder, grid};
    use super::*;
    use crate::mesh::Up;

    const SIZE: (usize, usize) = (400, 360);

    /// Four times the same square (1 m), face-on, with `paint`. Its views are 160 pixels square at
    /// these offsets.
    fn square(paint: Paint) -> Image {
        let flat = grid(1, 1, |u, v| Vec3::new(u, v, 0.0));
        let panel = PanelView { title: "Square", subject: flat.subject(), paint };
        draw(&[panel; 4], &Camera::fit(&flat.positions, Up::Y, 0.0, 0.0), SIZE)
    }

    /// Middle of the first panel's view.
    const MIDDLE: (usize, usize) = (100, 90);

    #[test]
    fn the_square_is_where_it_should_be_and_nothing_else() {
        let black = square(Paint::Phase { corners: &[] });
        // The view is 84 pixels high, with two pixels of air on each side.
        let ink = (0..160).flat_map(|x| (HEAD..HEAD + 84).map(move |y| (x + MARGIN, y)));
        let area: f64 = ink.map(|(x, y)| 1.0 - f64::from(black.pixel(x, y)[0]) / 255.0).sum();
        assert!((area / 6400.0 - 1.0).abs() < 0.01, "{area}");
        assert_eq!(black.pixel(MIDDLE.0, MIDDLE.1), [0; 3]);
        for (x, y) in [(30, 90), (170, 90), (100, HEAD + 1), (0, 0), (399, 359)] {
            assert_eq!(black.pixel(x, y), [255; 3], "background at {x}, {y}");
        }
    }

    #[test]
    fn a_face_without_phase_is_black_and_its_neighbour_is_not() {
        let image = square(Paint::Phase { corners: &[[f64::NAN, 0.0, 0.0], [0.0; 3]] });
        let (lower_right, upper_left) =
            (image.pixel(MIDDLE.0 + 15, MIDDLE.1 + 15), image.pixel(MIDDLE.0 - 15, MIDDLE.1 - 15));
        assert_eq!(lower_right, [0; 3]);
        assert!(
            upper_left[0] > 180 && upper_left[1] > 180 && upper_left[2] < 180,
            "a crest is yellow, not {upper_left:?}"
        );
    }

    #[test]
    fn one_face_carries_many_waves() {
        let (low, high) = (0.0, 10.0 * std::f64::consts::TAU);
        let image = square(Paint::Phase { corners: &[[low, high, high], [low, high, low]] });
        let dark: Vec<bool> = (62..138).map(|x| image.pixel(x, MIDDLE.1)[1] < 110).collect();
        let troughs = dark.windows(2).filter(|pair| !pair[0] && pair[1]).count();
        assert!((9..=10).contains(&troughs), "{troughs} troughs along ten waves");
    }

    #[test]
    fn amplitude_is_linear_inside_a_face_and_clamped() {
        let image =
            square(Paint::Scalar { values: &[0.0, 2.0, 0.0, 2.0], maximum: 1.0, unit: "mm" });
        let at = |x: usize| image.pixel(x, MIDDLE.1);
        assert!(
            at(64)[1] < 60 && at(135)[0] > 200,
            "violet on the left, yellow on the right: {:?}, {:?}",
            at(64),
            at(135)
        );
        assert_eq!(at(125), at(135));
        assert!(at(80)[1] > at(70)[1] + 20);
        let missing = square(Paint::Scalar { values: &[f64::NAN; 4], maximum: f64::NAN, unit: "" });
        let grey = missing.pixel(MIDDLE.0, MIDDLE.1);
        assert!(grey[0] == grey[1] && grey[1] == grey[2] && grey[0] < 200);
    }

    #[test]
    fn the_colour_bar_has_its_colours_and_both_labels() {
        let image = square(Paint::Scalar { values: &[0.0; 4], maximum: 0.5, unit: "mm" });
        let line = 180 - 36;
        // The bar is 72 pixels long, from 64 to 136.
        assert!(image.pixel(66, line + 10)[2] > 70 && image.pixel(133, line + 10)[0] > 230);
        let inked = |from: usize, to: usize| {
            (from..to)
                .flat_map(|x| (line..line + 20).map(move |y| (x, y)))
                .any(|(x, y)| image.pixel(x, y) != [255; 3])
        };
        assert!(inked(40, 60), "label at 0");
        assert!(inked(140, 199), "label at the maximum");
    }

    #[test]
    fn the_lines_of_a_wireframe_are_drawn_and_hidden_ones_are_not() {
        let flat = grid(1, 1, |u, v| Vec3::new(u, v, 0.0));
        let mut positions = flat.positions.clone();
        positions.extend([
            Vec3::new(0.2, 0.8, -0.5),
            Vec3::new(0.4, 0.9, -0.5),
            Vec3::new(0.3, 0.6, -0.5),
        ]);
        let mut faces = flat.faces.clone();
        faces.push([4, 5, 6]);
        let camera = Camera::fit(&positions, Up::Y, 0.0, 0.0);
        let view = |faces: &[[usize; 3]], wireframe| {
            let paint = Paint::Plain { colour: [200; 3], wireframe };
            draw(
                &[PanelView { title: "", subject: Subject { positions: &positions, faces }, paint };
                    4],
                &camera,
                SIZE,
            )
        };
        assert_eq!(view(&flat.faces, true), view(&faces, true));
        let (plain, wired) = (view(&faces, false), view(&faces, true));
        let darkest =
            (MIDDLE.0 - 3..=MIDDLE.0 + 3).map(|x| wired.pixel(x, MIDDLE.1)[0]).min().unwrap();
        assert!(darkest + 60 < plain.pixel(MIDDLE.0, MIDDLE.1)[0], "the diagonal");
        assert_eq!(
            wired.pixel(MIDDLE.0 + 20, MIDDLE.1 - 6),
            plain.pixel(MIDDLE.0 + 20, MIDDLE.1 - 6)
        );
    }

    #[test]
    fn each_panel_shows_its_own_subject() {
        let flat = grid(1, 1, |u, v| Vec3::new(u, v, 0.0));
        let half = Subject { positions: &flat.positions, faces: &flat.faces[..1] };
        let panel =
            |subject| PanelView { title: "", subject, paint: Paint::Phase { corners: &[] } };
        let panels = [flat.subject(), half, half, flat.subject()].map(panel);
        let image = draw(&panels, &Camera::fit(&flat.positions, Up::Y, 0.0, 0.0), SIZE);
        for (n, upper_left) in [[0; 3], [255; 3], [255; 3], [0; 3]].into_iter().enumerate() {
            let (x, y) = (MIDDLE.0 + SIZE.0 / 2 * (n % 2), MIDDLE.1 + SIZE.1 / 2 * (n / 2));
            assert_eq!(
                (image.pixel(x - 15, y - 15), image.pixel(x + 15, y + 15)),
                (upper_left, [0; 3]),
                "panel {n}"
            );
        }
    }

    #[test]
    fn both_sides_are_lit() {
        let flat = grid(1, 1, |u, v| Vec3::new(u, v, 0.0));
        let turned: Vec<_> = flat.faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let view = |faces: &[[usize; 3]]| {
            let paint = Paint::Plain { colour: [200; 3], wireframe: false };
            let panel = PanelView {
                title: "",
                subject: Subject { positions: &flat.positions, faces },
                paint,
            };
            draw(&[panel; 4], &Camera::fit(&flat.positions, Up::Y, 0.0, 0.0), SIZE)
        };
        assert_eq!(view(&flat.faces), view(&turned));
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_run_or_the_number_of_threads() {
        let with = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap()
                .install(|| cylinder((230, 40), (800, 600)))
        };
        let one = with(1);
        assert_eq!(one, with(2));
        assert_eq!(one, with(3));
        assert_eq!(one, cylinder((230, 40), (800, 600)));
        assert_ne!(one, cylinder((231, 40), (800, 600)), "the comparison can fail");
    }

    #[test]
    fn degenerate_subjects_and_sizes_do_not_panic() {
        let nan = Vec3::new(f64::NAN, f64::INFINITY, 0.0);
        let clouds = [
            vec![],
            vec![nan; 3],
            vec![Vec3::zeros(); 3],
            vec![Vec3::zeros(), Vec3::x(), Vec3::y() * 1e200, nan, Vec3::y()],
        ];
        for positions in &clouds {
            for up in [Up::Y, Up::Z] {
                let camera = Camera::automatic(positions, up);
                for faces in [vec![], vec![[0, 1, 2], [0, 1, 3], [7, 8, 9], [0, 1, 4]]] {
                    let subject = Subject { positions, faces: &faces };
                    let panels = [
                        PanelView {
                            title: "a",
                            subject,
                            paint: Paint::Plain { colour: [9; 3], wireframe: true },
                        },
                        PanelView {
                            title: "b",
                            subject,
                            paint: Paint::Scalar { values: &[], maximum: 0.0, unit: "mm" },
                        },
                        PanelView { title: "c", subject, paint: Paint::Phase { corners: &[] } },
                        PanelView {
                            title: "d",
                            subject,
                            paint: Paint::Plain { colour: [9; 3], wireframe: false },
                        },
                    ];
                    for size in [(0, 0), (1, 1), (90, 3), (400, 300)] {
                        let image = draw(&panels, &camera, size);
                        assert_eq!((image.width, image.height), size);
                    }
                }
            }
        }
    }
}
