//! How coarsely a frame is encoded: the quantization parameters of its blocks, as the decoder of H.264 tells them.
//!
//! In: FFmpeg's side data of a frame (`AVVideoEncParams`, libavutil/video_enc_params.h, read as bytes). Out: their
//! mean. A parameter of 0 to 51; the quantization step doubles with each 6 (ITU-T H.264, 8.5.9). Other codecs tell
//! nothing.

/// The option that has a decoder tell them.
pub(super) const EXPORT: (&str, &str) = ("export_side_data", "venc_params");
/// How much a parameter grows with each bit over 8 for the same share of full scale (8.5.8).
pub(super) const A_BIT: f64 = 6.0;
/// `AV_VIDEO_ENC_PARAMS_H264`.
const OF_H264: i32 = 1;

/// The mean over the blocks of a frame; `None` where `side_data` holds no blocks of H.264.
pub(super) fn mean(side_data: &[u8]) -> Option<f64> {
    let word = size_of::<usize>();
    let size = |at: usize| Some(usize::from_ne_bytes(side_data.get(at..at + word)?.try_into().ok()?));
    let int = |at: usize| Some(i32::from_ne_bytes(side_data.get(at..at + 4)?.try_into().ok()?));
    // A count, padded to a word; two sizes; type and parameter of the frame. A block: place, extent, difference.
    let (blocks, first, each) = (usize::try_from(int(0)?).ok()?, size(word)?, size(2 * word)?);
    let (kind, of_frame) = (int(3 * word)?, int(3 * word + 4)?);
    if kind != OF_H264 || blocks == 0 {
        return None;
    }
    let difference = |block: usize| int(first.checked_add(block.checked_mul(each)?)?.checked_add(16)?);
    let sum = (0..blocks).try_fold(0_i64, |sum, block| Some(sum + i64::from(difference(block)?)))?;
    Some(f64::from(of_frame) + sum as f64 / blocks as f64)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::video::{Codec, Encoder, Encoding, Format, Item, Picture, Video};

    /// The first frames' parameters of a noisy video.
    fn parameters(depth: u32, codec: Codec, crf: u32) -> Vec<Option<f64>> {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("video.mp4");
        let format = Format { width: 96, height: 64, subsampling: Some((2, 2)), depth };
        let mut encoder = Encoder::create(&path, &Encoding { codec, crf, ..Encoding::new(format) }).expect("a file");
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for k in 0..6 {
            let mut picture = Picture::new(format);
            for plane in &mut picture.planes {
                for sample in plane.chunks_exact_mut(format.sample_bytes()) {
                    let value = random.random_range(60_u16..190) << (depth - 8);
                    sample.copy_from_slice(&value.to_le_bytes()[..sample.len()]);
                }
            }
            encoder.push(&picture, 33 * k).expect("encoded");
        }
        encoder.finish().expect("written");
        let mut video = Video::open(&path, 1).expect("a video");
        let mut all = Vec::new();
        while let Some(item) = video.next_item().expect("a frame") {
            let Item::Frame(frame) = item else { panic!("a frame is missing") };
            all.push(frame.quantizer);
        }
        assert_eq!(all.len(), 6);
        all
    }

    #[test]
    fn h264_tells_its_steps_on_one_scale_and_hevc_none() {
        let mean = |depth, crf| {
            let all: Option<Vec<f64>> = parameters(depth, Codec::H264, crf).into_iter().collect();
            let all = all.expect("known");
            all.iter().sum::<f64>() / all.len() as f64
        };
        let [fine, coarse] = [20, 32].map(|crf| mean(8, crf));
        // A rate factor is about the parameter of frames that nothing is predicted from.
        assert!((10.0..=30.0).contains(&fine) && (9.0..=15.0).contains(&(coarse - fine)), "{fine} {coarse}");
        let deep = mean(10, 20);
        assert!((deep - fine).abs() <= 4.0, "{deep} of 10 bits, {fine} of 8");
        assert_eq!(parameters(8, Codec::Hevc, 28), vec![None; 6]);
    }

    #[test]
    fn what_is_cut_short_or_of_another_codec_tells_nothing() {
        let word = size_of::<usize>();
        let mut data = vec![0; 3 * word + 40];
        let int = |data: &mut [u8], at: usize, value: i32| data[at..at + 4].copy_from_slice(&value.to_ne_bytes());
        let size = |data: &mut [u8], at: usize, value: usize| data[at..at + word].copy_from_slice(&value.to_ne_bytes());
        let first = data.len();
        data.resize(first + 40, 0);
        int(&mut data, 0, 2);
        size(&mut data, word, first);
        size(&mut data, 2 * word, 20);
        int(&mut data, 3 * word, OF_H264);
        int(&mut data, 3 * word + 4, 26);
        int(&mut data, first + 16, 3);
        int(&mut data, first + 36, -4);
        assert_eq!(mean(&data), Some(25.5));
        for length in 0..data.len() {
            assert_eq!(mean(&data[..length]), None, "{length} bytes");
        }
        size(&mut data, word, usize::MAX - 3);
        assert_eq!(mean(&data), None);
        int(&mut data, 3 * word, 0);
        assert_eq!(mean(&data), None);
    }
}
