//! How coarsely a frame is encoded: the quantization parameters of its blocks, as the decoder of H.264 tells them.
//!
//! In: FFmpeg's side data of a frame (`AVVideoEncParams`, libavutil/video_enc_params.h, read as bytes). Out: their mean.
//! A parameter of 0 to 51; the quantization step doubles with each 6 (ITU-T H.264, 8.5.9). Other codecs tell nothing.

/// The option that has a decoder tell them.
pub(super) const EXPORT: (&str, &str) = ("export_side_data", "venc_params");
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
