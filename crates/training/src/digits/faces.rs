//! Typefaces to draw digits with: those that come along and those of a folder.

use std::path::{Path, PathBuf};

use ab_glyph::{Font, FontRef, FontVec, PxScale, ScaleFont};
use anyhow::Context;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::mask::{FINE, Mask, tight};
use super::segments::Display;

/// Families that nothing is trained on, by the beginning of their files' names.
const HELD_OUT: [&str; 10] =
    ["Inter", "JetBrains", "Oxygen", "Karla", "B612", "LeagueMono", "PT", "Vollkorn", "Dosis", "OpenSans"];
/// Files whose digits are framed, symbols, or of another script.
const STRANGE: [&str; 10] = [
    "AmiriQuran",
    "Caliban",
    "DSEGWeather",
    "ManchuFont",
    "NotoSansMath",
    "NotoSansSymbols",
    "NotoTraditionalNushu",
    "StandardSymbols",
    "Symbola",
    "Unikuweb",
];
/// Characters that are no digits and look like none.
const OTHERS: &str = ":.,-/'AEFHKMNPRTVWXYhmnkrtuwx+*=%";
/// Displays of each kind.
const DISPLAYS: u32 = 400;

/// One typeface's digits and other characters, and how far each advances, units.
#[derive(Debug, Clone)]
pub struct Face {
    /// Of its file's name, up to the first character that is no letter.
    pub family: String,
    pub(super) digits: Vec<(Mask, f32)>,
    pub(super) others: Vec<(Mask, f32)>,
    /// The box that holds any digit, units.
    pub(super) cell: [f32; 4],
}

/// All of them, by family.
pub struct Faces {
    /// Typefaces by family.
    pub families: Vec<Vec<Face>>,
    /// Seven-segment displays.
    pub displays: Vec<Display>,
}

impl Faces {
    /// Those to train with, or those held out, of a folder of `.ttf` and `.otf` files; without it, the typefaces that
    /// come along, of which none is held out.
    ///
    /// # Errors
    /// A folder or file that can't be read, with its path.
    pub fn load(folder: Option<&Path>, held_out: bool) -> anyhow::Result<Self> {
        let mut faces = Vec::new();
        if !held_out {
            for (name, bytes) in
                [("Hack", epaint_default_fonts::HACK_REGULAR), ("Ubuntu", epaint_default_fonts::UBUNTU_LIGHT)]
            {
                let font = FontRef::try_from_slice(bytes).context(name)?;
                faces.extend(Face::of(name, &font));
            }
        }
        let mut files = Vec::new();
        if let Some(folder) = folder {
            list(folder, &mut files)?;
        }
        // By name, not by path: the same wherever they are.
        files.sort_by_key(|path| path.file_name().map(ToOwned::to_owned));
        for path in files {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let is_of = |names: &[&str]| names.iter().any(|begins| name.starts_with(begins));
            if is_of(&STRANGE) || is_of(&HELD_OUT) != held_out {
                continue;
            }
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            let Ok(font) = FontVec::try_from_vec(bytes) else { continue };
            faces.extend(Face::of(&name, &font));
        }
        let mut families: Vec<Vec<Face>> = Vec::new();
        for face in faces {
            let known = |other: &Face| other.digits.iter().zip(&face.digits).all(|(a, b)| a.0.ink == b.0.ink);
            if families.iter().flatten().any(known) {
                continue;
            }
            match families.iter_mut().find(|family| family[0].family == face.family) {
                Some(family) => family.push(face),
                None => families.push(vec![face]),
            }
        }
        let mut rng = ChaCha8Rng::seed_from_u64(if held_out { 77 } else { 7 });
        let displays = (0..DISPLAYS).map(|_| Display::random(&mut rng)).collect();
        Ok(Self { families, displays })
    }

    /// Any of them, each family as often.
    pub(super) fn face(&self, rng: &mut impl Rng) -> &Face {
        let family = &self.families[rng.random_range(0..self.families.len())];
        &family[rng.random_range(0..family.len())]
    }

    /// Any of the displays.
    pub(super) fn display(&self, rng: &mut impl Rng) -> &Display {
        &self.displays[rng.random_range(0..self.displays.len())]
    }
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|e| e == "ttf" || e == "otf") {
            files.push(path);
        }
    }
    Ok(())
}

impl Face {
    /// None where a digit is missing, or they differ in height as those do that stand between lower-case letters.
    fn of(name: &str, font: &impl Font) -> Option<Self> {
        let family = name.split(|c: char| !c.is_ascii_alphabetic()).next().unwrap_or_default().to_owned();
        let size = 200.0;
        let bounds = |c: char| {
            let glyph = font.glyph_id(c).with_scale(size);
            Some(font.outline_glyph(glyph)?.px_bounds())
        };
        let all: Vec<ab_glyph::Rect> = ('0'..='9').map(bounds).collect::<Option<_>>()?;
        let (top, bottom) = (all[8].min.y, all[8].max.y);
        let tall = bottom - top;
        let lining =
            |b: &ab_glyph::Rect| (b.min.y - top).abs() <= 0.09 * tall && (b.max.y - bottom).abs() <= 0.09 * tall;
        let sane = all.iter().all(|b| (0.03..1.1).contains(&(b.width() / tall))) && all[8].width() > 0.3 * tall;
        if tall < 20.0 || !all.iter().all(lining) || !sane {
            return None;
        }
        let scale = PxScale::from(size * FINE / tall);
        let scaled = font.as_scaled(scale);
        let top = top * FINE / tall;
        let draw = |c: char| {
            let id = font.glyph_id(c);
            let outline = font.outline_glyph(id.with_scale(scale))?;
            let b = outline.px_bounds();
            let (width, height) = (b.width().ceil() as usize, b.height().ceil() as usize);
            let mut ink = vec![0; width * height];
            outline.draw(|x, y, share| {
                if (x as usize) < width && (y as usize) < height {
                    ink[y as usize * width + x as usize] = (255.0 * share.clamp(0.0, 1.0)) as u8;
                }
            });
            let mask = Mask::new(width, [b.min.x / FINE, (b.min.y - top) / FINE], ink);
            let inked = !mask.edge.is_empty();
            inked.then(|| (mask, scaled.h_advance(id) / FINE))
        };
        let digits: Vec<_> = ('0'..='9').map(draw).collect::<Option<_>>()?;
        let distinct = (0..10).all(|a| (0..a).all(|b| digits[a].0.ink != digits[b].0.ink));
        // Without letters, only marks.
        let others: Vec<_> = OTHERS.chars().filter(|&c| font.glyph_id(c).0 != 0).filter_map(draw).collect();
        let cell = tight(digits.iter().flat_map(|(mask, _)| mask.edge.iter().copied()));
        (distinct && !others.is_empty()).then_some(Self { family, digits, others, cell })
    }
}
