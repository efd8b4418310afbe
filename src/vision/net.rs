//! Networks by OpenCV's `dnn`: one graph, as many copies of it as there are threads at work.
//!
//! In: planes of numbers, channel by channel. Out: planes. The same numbers whatever the threads: each call has a copy
//! of its own, and within it OpenCV uses one thread.

use std::sync::{Mutex, PoisonError};

use half::f16;
use opencv::core::{Mat, Vector};
use opencv::dnn::{DNN_BACKEND_OPENCV, Net, read_net_from_onnx_buffer};
use opencv::prelude::*;

use super::{VisionError, ready, size};

/// A graph and copies of it that nobody uses.
pub(crate) struct Network {
    onnx: Vector<u8>,
    idle: Mutex<Vec<Net>>,
}

/// Numbers, channel by channel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Planes {
    /// Channels, rows, columns.
    pub(crate) size: [usize; 3],
    pub(crate) values: Vec<f32>,
}

impl Network {
    /// A network from an ONNX file's bytes whose weights were packed to 16 bits, see [`unpacked`].
    pub(crate) fn of_packed(packed: &[u8]) -> Result<Self, VisionError> {
        let onnx = unpacked(packed).ok_or_else(|| VisionError::lacking("readNetFromONNX", "the file is cut"))?;
        let network = Self { onnx: Vector::from_slice(&onnx), idle: Mutex::default() };
        let first = network.copy()?;
        network.give_back(first);
        Ok(network)
    }

    fn copy(&self) -> Result<Net, VisionError> {
        ready()?;
        let mut net = read_net_from_onnx_buffer(&self.onnx).map_err(VisionError::of("readNetFromONNX"))?;
        net.set_preferable_backend(DNN_BACKEND_OPENCV).map_err(VisionError::of("setPreferableBackend"))?;
        Ok(net)
    }

    fn give_back(&self, net: Net) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(net);
    }

    /// What the network answers.
    pub(crate) fn answer(&self, planes: &Planes) -> Result<Planes, VisionError> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut net = idle.map_or_else(|| self.copy(), Ok)?;
        let answer = forward(&mut net, planes);
        self.give_back(net);
        answer
    }
}

fn forward(net: &mut Net, planes: &Planes) -> Result<Planes, VisionError> {
    const CALL: &str = "Net::forward";
    let [channels, rows, columns] = planes.size;
    let sizes = [1, size(channels)?, size(rows)?, size(columns)?];
    let input = Mat::new_nd_with_data(&sizes, &planes.values).map_err(VisionError::of("Mat"))?;
    net.set_input_def(&input).map_err(VisionError::of("Net::setInput"))?;
    let answer = net.forward_single_def().map_err(VisionError::of(CALL))?;
    let shape: Vec<usize> = answer.mat_size().iter().map(|&n| usize::try_from(n).unwrap_or(0)).collect();
    let values = answer.data_typed::<f32>().map_err(VisionError::of(CALL))?.to_vec();
    match shape[..] {
        [1, channels, rows, columns] if channels * rows * columns == values.len() && !values.is_empty() => {
            Ok(Planes { size: [channels, rows, columns], values })
        }
        _ => Err(VisionError::lacking(CALL, format!("no planes: {shape:?}"))),
    }
}

/// An ONNX file's bytes from chunks of: a length (u32, little-endian) and so many bytes as they are; a count and so
/// many weights of 16 bits, which become 32. OpenCV 4.6 reads no weights of 16 bits.
fn unpacked(mut packed: &[u8]) -> Option<Vec<u8>> {
    let mut onnx = Vec::with_capacity(2 * packed.len());
    while !packed.is_empty() {
        onnx.extend_from_slice(taken(&mut packed, 1)?);
        let weights = taken(&mut packed, 2)?.as_chunks::<2>().0;
        onnx.extend(weights.iter().flat_map(|&bytes| f16::from_le_bytes(bytes).to_f32().to_le_bytes()));
    }
    Some(onnx)
}

/// The next so many things of `bytes` each, their count before them.
fn taken<'a>(packed: &mut &'a [u8], bytes: usize) -> Option<&'a [u8]> {
    let (count, rest) = packed.split_first_chunk::<4>()?;
    let (chunk, rest) = rest.split_at_checked(usize::try_from(u32::from_le_bytes(*count)).ok()?.checked_mul(bytes)?)?;
    *packed = rest;
    Some(chunk)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_widened_and_a_cut_file_is_refused() {
        let mut packed = vec![3, 0, 0, 0, b'a', b'b', b'c', 2, 0, 0, 0];
        packed.extend(f16::from_f32(0.5).to_le_bytes());
        packed.extend(f16::from_f32(-3.0).to_le_bytes());
        let mut onnx = b"abc".to_vec();
        onnx.extend(0.5_f32.to_le_bytes());
        onnx.extend((-3.0_f32).to_le_bytes());
        assert_eq!(unpacked(&packed), Some(onnx));
        for cut in 1..packed.len() {
            assert!(unpacked(&packed[..cut]).is_none(), "cut at {cut}");
        }
        assert!(Network::of_packed(&packed).is_err());
        assert!(Network::of_packed(&[]).is_err());
    }
}
