//! Memory follows what a file holds, not what it claims; and reading takes little besides the samples.

use dolomite_elevation::{Elevation, NumberType, Options, Raw};
use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes in use, and the most that ever were since the last look.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

/// One case at a time: the counters are the process's.
static ALONE: Mutex<()> = Mutex::new(());

struct Counting;

#[expect(
    unsafe_code,
    reason = "an allocator that counts is the one way to see every allocation, the decoders' too"
)]
// SAFETY: every call is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = IN_USE.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`, which is the system's too.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        let now = IN_USE.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(now, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Whether it was read, and the most memory that it took.
fn take(read: impl FnOnce() -> bool) -> (bool, usize) {
    let base = IN_USE.load(Ordering::Relaxed);
    PEAK.store(base, Ordering::Relaxed);
    let done = read();
    (done, PEAK.load(Ordering::Relaxed) - base)
}

fn file(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    std::fs::read(folder.join(name)).expect("it is there")
}

/// What decoders hold whatever the file: windows, tables, buffers; `tiff` up to 1 MiB of a tag's values before it sees that
/// the file has fewer, and its growing list of them.
const BASE: usize = 4 << 20;

#[test]
fn reading_takes_a_quarter_more_than_the_samples_at_most() {
    let _alone = ALONE.lock().unwrap();
    let side = 2049_u32;
    let samples = 4 * (side * side) as usize;
    let number = |k: u32| (k % side + k / side) as u16;
    let raw: Vec<u8> = (0..side * side)
        .flat_map(|k| number(k).to_be_bytes())
        .collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&raw)
        .unwrap();
    let path = std::env::temp_dir().join(format!("dolomite-memory-{}", std::process::id()));
    let layout = Raw {
        size: Some([side; 2]),
        number: Some(NumberType::U16),
        ..Raw::default()
    };
    for (name, bytes, raw) in [("a.raw", &raw, Some(layout)), ("a.png", &png, None)] {
        std::fs::write(&path, bytes).unwrap();
        let options = Options {
            raw,
            ..Options::default()
        };
        let (read, peak) = take(|| Elevation::read(&path, &options).is_ok());
        let ratio = peak as f64 / samples as f64;
        println!("{name}: {ratio:.3} of the samples");
        assert!(read && ratio <= 1.25, "{name}: {ratio}");
    }
    std::fs::remove_file(&path).unwrap();
}

/// A packed byte may stand for some thousands, so a file that was changed may ask for as many: but for no more,
/// however many samples its header claims.
#[test]
fn changed_headers_take_no_more_than_their_bytes_allow() {
    let _alone = ALONE.lock().unwrap();
    let mut most = 0;
    for name in [
        "u16-gdal.png",
        "i16-gdal.asc",
        "i16-gdal-strips.tif",
        "i16-gdal-lzw-p2-tiles.tif",
        "f32-gdal-bigtiff-big-tiles.tif",
        "f32-gdal-cog.tif",
    ] {
        let bytes = file(name);
        // Deflate makes 1 032 bytes of one, LZW fewer than 4 096; 4 bytes of a sample for 2 of the file.
        let packed = name.contains("png") || name.contains("lzw") || name.contains("cog");
        let bound = BASE + bytes.len() * if packed { 2 * 4096 } else { 16 };
        for at in 0..bytes.len().min(700) {
            for flip in [0xff, 0x01, 0x80, 0x40] {
                let mut changed = bytes.clone();
                changed[at] ^= flip;
                let (_, peak) =
                    take(|| Elevation::decode(name, &changed, &Options::default()).is_ok());
                most = most.max(peak);
                assert!(
                    peak <= bound,
                    "{name}, byte {at} ^ {flip:#x}: {peak} of {bound}"
                );
            }
        }
    }
    println!("{most} bytes at most");
}
