//! What is no video: each case says what is wrong and what to do.

use std::path::Path;

use lunula::video::{Encoder, Encoding, Video};

use super::scene::{SMALL, find, patched, uneven, write};

#[track_caller]
fn refused(path: &Path, words: &[&str]) {
    let error = Video::open(path, 1).err().expect("no video").to_string();
    assert!(error.starts_with(&*path.display().to_string()), "{error}");
    for word in words {
        assert!(error.contains(word), "`{word}` is not in: {error}");
    }
}

#[test]
fn no_file_no_bytes_a_folder_and_a_text() {
    let folder = tempfile::tempdir().unwrap();
    refused(&folder.path().join("nothing.mp4"), &["is not there", "check its name"]);
    refused(folder.path(), &["is a folder"]);
    let path = folder.path().join("a.mp4");
    std::fs::write(&path, b"").unwrap();
    refused(&path, &["empty", "again"]);
    std::fs::write(&path, "frame,time_s\n0,0.0\n".repeat(20)).unwrap();
    refused(&path, &["not a video"]);
}

#[test]
fn sound_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let mut wav =
        b"RIFF\x24\x10\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x80\x3e\0\0\x02\0\x10\0data\0\x10\0\0".to_vec();
    wav.resize(44 + 4096, 0);
    std::fs::write(&path, wav).unwrap();
    refused(&path, &["sound but no video"]);
}

#[test]
fn an_index_that_was_never_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, &Encoding::new(SMALL), 20, uneven);
    let within = patched(&path, "b.mp4", |bytes| {
        let moov = find(bytes, &[b"moov"]);
        bytes.truncate((moov.start + moov.end) / 2);
    });
    refused(&within, &["cut off before its index", "untrunc"]);
    let without = patched(&path, "c.mp4", |bytes| {
        let moov = find(bytes, &[b"moov"]);
        bytes.drain(moov.start - 8..moov.end);
    });
    refused(&without, &["cut off before its index"]);
}

#[test]
fn no_frames_and_none_that_decodes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    Encoder::create(&path, &Encoding::new(SMALL)).unwrap().finish().unwrap();
    refused(&path, &["no video"]);
    write(&path, &Encoding::new(SMALL), 10, uneven);
    let empty = patched(&path, "c.mp4", |bytes| {
        // Tables of nothing: times, sizes, chunks.
        for (table, count_at) in [(b"stts", 4), (b"stsz", 8), (b"stsc", 4), (b"stco", 4), (b"ctts", 4), (b"stss", 4)] {
            let table = find(bytes, &[b"moov", b"trak", b"mdia", b"minf", b"stbl", table]);
            bytes[table.start + count_at..][..4].fill(0);
        }
    });
    refused(&empty, &["without frames"]);
    let zeros = patched(&path, "b.mp4", |bytes| {
        let mdat = find(bytes, &[b"mdat"]);
        bytes[mdat].fill(0);
    });
    refused(&zeros, &["none of its 10 frames can be decoded"]);
}
