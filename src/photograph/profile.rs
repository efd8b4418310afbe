//! The colours that a picture file's samples mean, where they are not sRGB's.
//!
//! Samples are taken as the file encodes them, whatever its profile says: so do OpenCV and MATLAB, and so did the
//! thesis. Within a set that is of one profile it does no harm. Green of skin is 2.6 of 255 higher in Display P3
//! (phones) than in sRGB, so a set that mixes profiles differs by them; and sRGB's curve may be undone only where it
//! was used.

use image::ImageDecoder;
use moxcms::{ColorProfile, DataColorSpace, Layout, ProfileText, TransformOptions};

/// A colour profile that is not sRGB.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// By its own description.
    pub name: String,
    /// How much higher it encodes the green of skin than sRGB does, of 255.
    pub skin_green: f32,
    /// How much higher it encodes a middle grey than sRGB does, of 255: not 0 where its curve is not sRGB's.
    pub grey: f32,
}

/// Skin in the light of a window, and a middle grey, as sRGB encodes them.
const SKIN: [f32; 3] = [200.0, 150.0, 130.0];
const GREY: f32 = 128.0;
/// A middle grey of 255 from which on a curve is not sRGB's. A gamma of 2.2 differs by 1.
const OTHER_CURVE: f32 = 3.0;
/// Cameras mark Adobe RGB by an interoperability index alone (DCF 2.0, 4.5): EXIF's entry of tag 1, 4 letters.
const ADOBE_RGB_BY_EXIF: [&[u8]; 2] =
    [b"\x01\x00\x02\x00\x04\x00\x00\x00R03\0", b"\x00\x01\x00\x02\x00\x00\x00\x04R03\0"];

impl Profile {
    /// Colours encoded less differently than this, of 255, are of one profile by several names: makers' own versions of
    /// sRGB differ in their last digits.
    pub const SAME: f32 = 0.5;

    /// Whether `--linear`, which undoes sRGB's curve, would undo one that was never applied.
    pub fn has_other_curve(&self) -> bool {
        self.grey.abs() >= OTHER_CURVE
    }

    /// Of a picture about to be decoded; `None` where it is sRGB, or says nothing that can be read.
    pub(super) fn of(decoder: &mut impl ImageDecoder) -> Option<Self> {
        let is_colour = decoder.color_type().has_color();
        if let Some(bytes) = decoder.icc_profile().ok().flatten() {
            return Self::of_icc(&ColorProfile::new_from_slice(&bytes).ok()?, is_colour);
        }
        let exif = decoder.exif_metadata().ok().flatten().filter(|_| is_colour)?;
        let is_adobe = ADOBE_RGB_BY_EXIF.iter().any(|entry| memchr::memmem::find(&exif, entry).is_some());
        is_adobe.then(|| Self::of_icc(&ColorProfile::new_adobe_rgb(), true)).flatten()
    }

    /// Of a PNG that states a gamma (its chunk gAMA) and no profile, where that is no curve like sRGB's: 1 is linear.
    pub(super) fn of_png_gamma(bytes: &[u8]) -> Option<Self> {
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
        let info = reader.info();
        let gamma = info.gama_chunk?.into_value();
        if info.icc_profile.is_some() || info.srgb.is_some() || gamma <= 0.0 {
            return None;
        }
        let srgb =
            |linear: f32| if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        let higher = |encoded: f32| encoded - 255.0 * srgb((encoded / 255.0).powf(1.0 / gamma));
        let name = format!("gamma {:.2} (gAMA)", 1.0 / gamma);
        Some(Self { name, skin_green: higher(SKIN[1]), grey: higher(GREY) }).filter(Self::has_other_curve)
    }

    fn of_icc(profile: &ColorProfile, is_colour: bool) -> Option<Self> {
        let (layout, space) =
            if is_colour { (Layout::Rgb, DataColorSpace::Rgb) } else { (Layout::Gray, DataColorSpace::Gray) };
        if profile.color_space != space {
            return None;
        }
        let srgb = ColorProfile::new_srgb();
        let to_srgb = profile.create_transform_f32(layout, &srgb, Layout::Rgb, TransformOptions::default()).ok()?;
        // What is encoded so is darker in sRGB by as much as the profile encodes it higher.
        let higher = |encoded: [f32; 3]| {
            let mut shown = [0.0; 3];
            let encoded_fractions = encoded.map(|value| value / 255.0);
            to_srgb.transform(&encoded_fractions[..if is_colour { 3 } else { 1 }], &mut shown).ok()?;
            Some(encoded[1] - 255.0 * shown[1])
        };
        let grey = higher([GREY; 3])?;
        let skin_green = if is_colour { higher(SKIN)? } else { higher([SKIN[1]; 3])? };
        let is_srgb = grey.abs() < Self::SAME && skin_green.abs() < Self::SAME;
        (!is_srgb).then(|| Self { name: described(profile), skin_green, grey })
    }
}

/// A profile's description of itself, in one short line.
fn described(profile: &ColorProfile) -> String {
    const LETTERS: usize = 40;
    let text = match &profile.description {
        Some(ProfileText::PlainString(text)) => text.as_str(),
        Some(ProfileText::Localizable(texts)) => {
            texts.iter().find(|text| text.language == "en").or(texts.first()).map_or("", |text| &text.value)
        }
        Some(ProfileText::Description(text)) => &text.ascii_string,
        None => "",
    };
    let line: String = text.chars().filter(|letter| !letter.is_control()).take(LETTERS).collect();
    if line.trim().is_empty() { "a profile without a name".to_owned() } else { line.trim().to_owned() }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_png_that_states_another_gamma_has_another_curve() {
        let stored = |gamma: Option<f32>, srgb: bool| {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
            encoder.set_color(png::ColorType::Rgb);
            if srgb {
                encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            }
            gamma.into_iter().for_each(|gamma| encoder.set_source_gamma(png::ScaledFloat::new(gamma)));
            encoder.write_header().unwrap().write_image_data(&[128; 6]).unwrap();
            Profile::of_png_gamma(&bytes)
        };
        let linear = stored(Some(1.0), false).unwrap();
        // A linear 128 of 255 is 188 in sRGB.
        assert!(linear.has_other_curve() && (linear.grey + 60.0).abs() < 1.0, "{linear:?}");
        assert_eq!([stored(Some(0.454_55), false), stored(None, false), stored(Some(1.0), true)], [None, None, None]);
    }

    use std::path::Path;

    use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
    use image::{DynamicImage, GrayImage, ImageEncoder, RgbImage};
    use moxcms::ColorProfile;

    use crate::photograph::{Photograph, Profile, ReadFault};

    fn read(encode: impl FnOnce(&Path)) -> Photograph {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("picture");
        encode(&path);
        Photograph::read(&path).expect("a photograph")
    }

    fn with_icc(picture: impl Into<DynamicImage>, icc: Vec<u8>) -> Photograph {
        let picture = picture.into();
        read(|path| {
            let mut encoder = PngEncoder::new(std::fs::File::create(path).expect("a file"));
            encoder.set_icc_profile(icc).expect("PNG has profiles");
            picture.write_with_encoder(encoder).expect("written");
        })
    }

    fn icc(profile: &ColorProfile) -> Vec<u8> {
        profile.encode().expect("a profile")
    }

    fn colour() -> RgbImage {
        RgbImage::from_pixel(8, 8, image::Rgb([200, 150, 130]))
    }

    /// By hand: sRGB's (200, 150, 130) in Display P3 (DCI-P3's primaries, D65, sRGB's curve) is (193.4, 152.2, 133.4).
    #[test]
    fn a_profile_says_how_much_higher_it_encodes_green() {
        let profile = with_icc(colour(), icc(&ColorProfile::new_display_p3())).profile.expect("not sRGB");
        assert!((profile.skin_green - 2.5).abs() < 0.6 && profile.grey.abs() < 0.1, "{profile:?}");
        assert!(!profile.has_other_curve() && profile.name.contains("P3"), "{profile:?}");
        let adobe = with_icc(colour(), icc(&ColorProfile::new_adobe_rgb())).profile.expect("not sRGB");
        assert!(!adobe.has_other_curve() && adobe.skin_green.abs() < 2.0, "{adobe:?}");
        for (mark, is_there) in [(&b"R03\0"[..], true), (b"R98\0", false)] {
            // Exif's head, one directory of one entry in either order of bytes.
            for entry in
                [&b"MM\0*\0\0\0\x08\0\x01\0\x01\0\x02\0\0\0\x04"[..], b"II*\0\x08\0\0\0\x01\0\x01\0\x02\0\x04\0\0\0"]
            {
                let photograph = read(|path| {
                    let mut encoder = JpegEncoder::new(std::fs::File::create(path).expect("a file"));
                    encoder.set_exif_metadata([entry, mark, &[0; 4]].concat()).expect("JPEG has it");
                    DynamicImage::from(colour()).write_with_encoder(encoder).expect("written");
                });
                assert_eq!(photograph.profile.map(|profile| profile.name), is_there.then(|| adobe.name.clone()));
            }
        }
    }

    #[test]
    fn srgb_by_any_name_and_what_can_t_be_read_are_none() {
        let srgb = icc(&ColorProfile::new_srgb());
        let cut = srgb[..srgb.len() / 2].to_vec();
        for bytes in [srgb, cut, b"no profile".to_vec(), icc(&ColorProfile::new_gray_with_gamma(1.0))] {
            assert_eq!(with_icc(colour(), bytes).profile, None);
        }
        // Samples are the file's own, whatever the profile.
        let photograph = with_icc(colour(), icc(&ColorProfile::new_display_p3()));
        assert_eq!(photograph.image.as_rgb8(), Some(&colour()));
    }

    #[test]
    fn a_curve_that_is_not_srgb_s_is_not_undone_as_if() {
        let pro_photo = with_icc(colour(), icc(&ColorProfile::new_pro_photo_rgb()));
        assert!(matches!(pro_photo.has_srgb_curve(), Err(ReadFault::OtherCurve(name)) if name.contains("ProPhoto")));
        let grey = |gamma| with_icc(GrayImage::new(8, 8), icc(&ColorProfile::new_gray_with_gamma(gamma)));
        assert!(grey(1.0).has_srgb_curve().is_err() && grey(2.2).has_srgb_curve().is_ok());
        // A linear middle grey is 188 of 255 in sRGB.
        let linear: Profile = grey(1.0).profile.expect("not sRGB");
        assert!((linear.grey + 60.0).abs() < 1.0, "{linear:?}");
    }
}
