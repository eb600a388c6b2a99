//! Small pictures made here, and what is wrong with others.

use super::{ImageError, ImageFacts, Kind, read};

const LIMIT: u64 = 1 << 20;

fn encoded(color: png::ColorType, width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    let data = vec![7; color.samples() * width as usize * height as usize];
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&data).expect("rows");
    drop(writer);
    bytes
}

/// The smallest grey JPEG: headers, one scan, the end.
fn jpeg(width: u16, height: u16, components: u8) -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    bytes.extend([1; 64]);
    bytes.extend([0xff, 0xc0, 0, 8 + 3 * components, 8]);
    bytes.extend(height.to_be_bytes());
    bytes.extend(width.to_be_bytes());
    bytes.push(components);
    bytes.extend((1..=components).flat_map(|component| [component, 0x11, 0]));
    bytes.extend([0xff, 0xc4, 0, 20, 0]);
    bytes.extend([1; 1]);
    bytes.extend([0; 15]);
    bytes.push(0);
    bytes.extend([0xff, 0xda, 0, 6 + 2 * components, components]);
    bytes.extend((1..=components).flat_map(|component| [component, 0]));
    bytes.extend([0, 63, 0, 0x00, 0xff, 0xd9]);
    bytes
}

#[test]
fn png_of_every_color() {
    for (color, alpha) in [
        (png::ColorType::Grayscale, false),
        (png::ColorType::Rgb, false),
        (png::ColorType::GrayscaleAlpha, true),
        (png::ColorType::Rgba, true),
    ] {
        let expected = ImageFacts { kind: Kind::Png, width: 5, height: 3, alpha };
        assert_eq!(read(&encoded(color, 5, 3), LIMIT), Ok(expected));
    }
}

#[test]
fn size_is_held_against_the_limit_first() {
    let mut bytes = encoded(png::ColorType::Grayscale, 100, 100);
    let expected = ImageError::TooLarge { width: 100, height: 100, limit: 9999 };
    assert_eq!(read(&bytes, 9999), Err(expected.clone()));
    assert!(read(&bytes, 10_000).is_ok());
    // The rest may be missing: nothing of it is read.
    bytes.truncate(45);
    assert_eq!(read(&bytes, 9999), Err(expected));
    let large = read(&jpeg(4000, 3000, 1), LIMIT).expect_err("too large");
    assert_eq!(large.to_string(), "the picture is 4000 x 3000 pixels, more than the limit of 1048576");
}

#[test]
fn every_cut_of_a_png_is_refused() {
    let bytes = encoded(png::ColorType::Rgb, 9, 9);
    for end in 0..bytes.len() - 12 {
        assert!(read(&bytes[..end], LIMIT).is_err(), "cut at {end}");
    }
}

#[test]
fn jpeg_headers() {
    let expected = ImageFacts { kind: Kind::Jpeg, width: 8, height: 16, alpha: false };
    assert_eq!(read(&jpeg(8, 16, 1), LIMIT), Ok(expected));
    let bytes = jpeg(8, 16, 1);
    assert!(matches!(
        read(&bytes[..bytes.len() - 2], LIMIT),
        Err(ImageError::Damaged { kind: Kind::Jpeg, .. })
    ));
    for end in 0..bytes.len() - 2 {
        assert!(read(&bytes[..end], LIMIT).is_err(), "cut at {end}");
    }
}

#[test]
fn other_formats_are_named() {
    let message = |bytes: &[u8]| read(bytes, LIMIT).expect_err("not a texture").to_string();
    assert_eq!(message(b"GIF89a"), "this is a GIF picture; textures are PNG or JPEG");
    assert_eq!(message(b""), "this is an empty file; textures are PNG or JPEG");
    assert_eq!(message(b"hello"), "this is not a picture; textures are PNG or JPEG");
}
