//! Titles and keys: text, colour bars and the scale bar, in whole pixels. `s` is the letter size: 1
//! gives letters 20 pixels high.

use super::colour::{Light, srgb_from_light};
use super::image::Image;
use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_10X20;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};

/// Colour of titles and labels.
pub(super) const INK: [u8; 3] = [32, 36, 44];
/// Colour of remarks.
pub(super) const QUIET: [u8; 3] = [96, 102, 114];

/// Width and height of a letter (pixels, at letter size 1).
const LETTER: (usize, usize) = (10, 20);

/// The point of a text that is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// Width (pixels) of `text` written whole.
pub(super) fn width(text: &str, s: usize) -> usize {
    text.chars().count() * LETTER.0 * s
}

/// Writes `text` with its upper left, middle or right at `at` (pixels), cut to `room` pixels.
/// Letters outside Latin-1 become "?".
pub(super) fn write(
    image: &mut Image,
    text: &str,
    at: (usize, usize),
    align: Align,
    room: usize,
    s: usize,
    colour: [u8; 3],
) {
    let fitting = room / (LETTER.0 * s);
    let length = text.chars().count();
    let text: String = if length <= fitting {
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
    } else if fitting > 4 {
        text.chars().take(fitting - 2).chain("..".chars()).collect()
    } else {
        return;
    };
    let width = text.chars().count() * LETTER.0 * s;
    let left = match align {
        Align::Left => at.0,
        Align::Centre => at.0.saturating_sub(width / 2),
        Align::Right => at.0.saturating_sub(width),
    };
    let mut sheet = Sheet { image, left, top: at.1, s, colour };
    let style = MonoTextStyle::new(&FONT_10X20, BinaryColor::On);
    let Ok(_) = Text::with_baseline(&text, Point::zero(), style, Baseline::Top).draw(&mut sheet);
}

/// Draws a bar of `width`·9/25 pixels centred at `middle` whose colours run from 0 to 1, with a
/// label at each end. Returns where the right label ends (pixels).
pub(super) fn colour_bar(
    image: &mut Image,
    (middle, top): (usize, usize),
    width: usize,
    labels: [&str; 2],
    s: usize,
    colour: impl Fn(f64) -> Light,
) -> usize {
    let length = (width * 9 / 25).max(2);
    let left = middle.saturating_sub(length / 2);
    let height = LETTER.1 * s;
    for x in 0..length {
        let c = srgb_from_light(colour(x as f64 / (length - 1) as f64));
        for y in 3 * s..height - 3 * s {
            let rim = x < s || x >= length - s || y < 4 * s || y >= height - 4 * s;
            image.set(left + x, top + y, if rim { INK } else { c });
        }
    }
    let gap = LETTER.0 * s;
    write(image, labels[0], (left.saturating_sub(gap), top), Align::Right, left, s, INK);
    write(image, labels[1], (left + length + gap, top), Align::Left, width, s, INK);
    left + length + gap + labels[1].chars().count() * LETTER.0 * s
}

/// Draws a filled square as high as a colour bar.
pub(super) fn swatch(image: &mut Image, (left, top): (usize, usize), colour: [u8; 3], s: usize) {
    for y in 3 * s..17 * s {
        for x in 0..14 * s {
            image.set(left + x, top + y, colour);
        }
    }
}

/// Draws a line `length` pixels long with a stop at each end, its middle height at `top`.
pub(super) fn scale_bar(image: &mut Image, (left, top): (usize, usize), length: usize, s: usize) {
    for x in 0..length.max(1) {
        let stop = x < 2 * s || x + 2 * s >= length;
        let reach = if stop { 6 * s } else { s };
        for y in top.saturating_sub(reach)..top + reach {
            image.set(left + x, y, INK);
        }
    }
}

/// `value` with three digits.
pub(super) fn three_digits(value: f64) -> String {
    // Rounded first, so that 9.996 counts as 10.0.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        "0".into()
    } else if (0.01..1000.0).contains(&rounded.abs()) {
        let decimals = (2 - rounded.abs().log10().floor() as i32).max(0) as usize;
        format!("{rounded:.decimals$}")
    } else if (1000.0..100_000.0).contains(&rounded.abs()) {
        format!("{rounded:.0}")
    } else {
        format!("{value:.2e}")
    }
}

/// The greatest 1, 2 or 5 times a power of ten not above `longest` (m), and how to write it. `None`
/// if there is none.
pub(super) fn round_length(longest: f64) -> Option<(f64, String)> {
    if !(longest > 1e-9 && longest < 1e12) {
        return None;
    }
    let power = 10f64.powi(longest.log10().floor() as i32);
    let length = [5.0, 2.0, 1.0]
        .map(|n| n * power)
        .into_iter()
        .find(|&l| l <= longest * (1.0 + 1e-12))
        .unwrap_or(power);
    let (unit, name) = match length {
        l if l >= 0.9999 => (1.0, "m"),
        l if l >= 0.9999e-3 => (1e-3, "mm"),
        l if l >= 0.9999e-6 => (1e-6, "\u{b5}m"),
        _ => (1e-9, "nm"),
    };
    Some((length, format!("{:.0} {name}", length / unit)))
}

/// Part of an image as something `embedded-graphics` draws on: each of its pixels becomes `s`×`s`.
struct Sheet<'a> {
    image: &'a mut Image,
    left: usize,
    top: usize,
    s: usize,
    colour: [u8; 3],
}

impl OriginDimensions for Sheet<'_> {
    fn size(&self) -> Size {
        Size::new(self.image.width as u32, self.image.height as u32)
    }
}

impl DrawTarget for Sheet<'_> {
    type Color = BinaryColor;
    type Error = std::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = embedded_graphics::Pixel<BinaryColor>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Self::Error> {
        for embedded_graphics::Pixel(point, ink) in pixels {
            if let (BinaryColor::On, Ok(x), Ok(y)) =
                (ink, usize::try_from(point.x), usize::try_from(point.y))
            {
                for dy in 0..self.s {
                    for dx in 0..self.s {
                        self.image.set(
                            self.left + x * self.s + dx,
                            self.top + y * self.s + dy,
                            self.colour,
                        );
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inked(image: &Image) -> Vec<(usize, usize)> {
        (0..image.height)
            .flat_map(|y| (0..image.width).map(move |x| (x, y)))
            .filter(|&(x, y)| image.pixel(x, y) != [255; 3])
            .collect()
    }

    #[test]
    fn text_stays_in_its_box() {
        for (align, left) in [(Align::Left, 100), (Align::Centre, 80), (Align::Right, 60)] {
            let mut image = Image::blank(200, 60);
            write(&mut image, "Wave", (100, 20), align, 200, 1, INK);
            let ink = inked(&image);
            assert!(ink.len() > 60);
            assert!(
                ink.iter().all(|&(x, y)| (left..left + 40).contains(&x) && (20..40).contains(&y))
            );
        }
    }

    #[test]
    fn long_text_is_cut_and_text_outside_is_not_drawn() {
        let mut image = Image::blank(200, 60);
        write(&mut image, "a title much too long for its panel", (0, 0), Align::Left, 100, 1, INK);
        assert!(inked(&image).iter().all(|&(x, _)| x < 100));
        write(&mut image, "outside", (500, 500), Align::Left, 100, 3, INK);
    }

    #[test]
    fn numbers_have_three_digits_and_lengths_are_round() {
        let cases = [
            (0.8324, "0.832"),
            (9.996, "10.0"),
            (12.0, "12.0"),
            (0.0456, "0.0456"),
            (1234.0, "1230"),
            (2.5e-7, "2.50e-7"),
            (0.0, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(three_digits(value), text);
        }
        for (longest, text) in
            [(0.07, "50 mm"), (1.0, "1 m"), (0.0021, "2 mm"), (3e-4, "200 \u{b5}m"), (45.0, "20 m")]
        {
            assert_eq!(round_length(longest).unwrap().1, text);
        }
        assert!(round_length(f64::NAN).is_none() && round_length(0.0).is_none());
    }
}
