//! Files in the format WAV: PCM of 16 bits, one channel.

/// The bytes of a file. Samples beyond −1 and 1 are cut.
pub fn wav(samples: &[f64], rate: u32) -> Vec<u8> {
    let data = 2 * samples.len() as u32;
    let mut bytes = Vec::with_capacity(44 + data as usize);
    bytes.extend(b"RIFF");
    bytes.extend((36 + data).to_le_bytes());
    bytes.extend(b"WAVEfmt ");
    bytes.extend(16_u32.to_le_bytes());
    for half in [1_u16, 1] {
        bytes.extend(half.to_le_bytes());
    }
    bytes.extend(rate.to_le_bytes());
    bytes.extend((2 * rate).to_le_bytes());
    for half in [2_u16, 16] {
        bytes.extend(half.to_le_bytes());
    }
    bytes.extend(b"data");
    bytes.extend(data.to_le_bytes());
    for sample in samples {
        let whole = libm::round(sample.clamp(-1.0, 1.0) * 32_767.0) as i16;
        bytes.extend(whole.to_le_bytes());
    }
    bytes
}
