//! Writing: the same bytes each time, and words for what can't be written.

use lunula::video::{Codec, Encoder, Encoding, Format, Picture};

use super::scene::{SMALL, numbered, uneven, write};

#[test]
fn the_same_pictures_make_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for codec in [Codec::H264, Codec::Hevc] {
        let encoding = Encoding { codec, crf: 30, ..Encoding::new(Format { width: 320, height: 180, ..SMALL }) };
        let bytes = || {
            let path = folder.path().join("a.mp4");
            write(&path, &encoding, 40, uneven);
            std::fs::read(path).unwrap()
        };
        let first = bytes();
        // After encoders of other settings, which leave other things in the memory that is used again.
        for depth in [8, 10, 8] {
            let other = Format { width: 160, height: 96, depth, ..SMALL };
            write(&folder.path().join("b.mp4"), &Encoding { codec, ..Encoding::new(other) }, 10, uneven);
            assert!(bytes() == first, "{codec:?}");
        }
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, encoding: &Encoding, words: &str| {
        let path = folder.path().join(name);
        let error = Encoder::create(&path, encoding).err().expect("no error").to_string();
        assert!(error.contains(words) && error.contains(name), "`{words}` is not in: {error}");
    };
    let small = Encoding::new(SMALL);
    refused("nowhere/a.mp4", &small, "can't be written");
    refused("a.h264", &Encoding { codec: Codec::Hevc, ..small.clone() }, "bare H.264 can't hold HEVC");
    refused("a.txt", &small, ".mp4, .mov, .mkv");
    refused("a.mp4", &Encoding::new(Format { width: 63, ..SMALL }), "odd width");
    refused("a.mp4", &Encoding::new(Format { depth: 12, ..SMALL }), "8 or 10 bits");
    std::fs::create_dir(folder.path().join("b.mp4")).unwrap();
    refused("b.mp4", &small, "can't be written");
}

#[test]
fn pictures_have_to_fit_and_to_come_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let mut encoder = Encoder::create(&folder.path().join("a.mp4"), &Encoding::new(SMALL)).unwrap();
    encoder.push(&numbered(SMALL, 0), 5).unwrap();
    let error = encoder.push(&numbered(SMALL, 1), 5).unwrap_err().to_string();
    assert!(error.contains("order of their times"), "{error}");
    let error = encoder.push(&Picture::new(Format { width: 66, ..SMALL }), 9).unwrap_err().to_string();
    assert!(error.contains("another size"), "{error}");
}
