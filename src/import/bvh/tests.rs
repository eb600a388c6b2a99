use super::{BvhFault, Channel, read};

const SMALL: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 5.5 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 2 0.5
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
0 0 0 0 0 0 10 20 30
1 2 3 4 5 6 7 8 9
";

#[test]
fn a_small_file_is_read() {
    let bvh = read(SMALL.as_bytes()).expect("it is whole");
    assert_eq!((bvh.joints.len(), bvh.frames.len(), bvh.frame_time), (2, 2, 0.04));
    let chest = &bvh.joints[1];
    assert_eq!((chest.parent, chest.first, chest.end), (Some(0), 6, Some([0.0, 2.0, 0.5])));
    assert_eq!(chest.channels, [Channel::Rotation(2), Channel::Rotation(0), Channel::Rotation(1)]);
    assert_eq!(bvh.frames[1][chest.first..], [7.0, 8.0, 9.0]);
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let fault = |from: &str, to: &str| {
        let text = SMALL.replace(from, to);
        assert_ne!(text, SMALL, "{from}");
        read(text.as_bytes()).expect_err(to)
    };
    assert_eq!(fault("HIERARCHY", "HIERARCHIE").line(), Some(1));
    assert_eq!(fault("5.5", "five").line(), Some(8));
    assert_eq!(fault("5.5", "nan").line(), Some(8));
    assert!(matches!(
        fault("CHANNELS 3 Zrotation Xrotation", "CHANNELS 3 Zrotation Zrotation"),
        BvhFault::Twice { line: 9, .. }
    ));
    assert!(matches!(fault("Frames: 2", "Frames: 3"), BvhFault::Frames { line: 17, announced: 3, found: 2 }));
    assert!(matches!(fault("7 8 9", "7 8"), BvhFault::Width { line: 20, frame: 2, found: 8, channels: 9 }));
    assert!(matches!(fault("0.04", "0"), BvhFault::Number { line: 18, .. }));
    assert!(matches!(fault("End Site", "End Sight"), BvhFault::Expected { line: 10, .. }));
    assert_eq!(read(&[0xFF, 0xFE]), Err(BvhFault::NotText));
}

/// Every start of the file and every flipped bit: refused or read, never worse.
#[test]
fn damaged_files_are_refused_or_read() {
    for end in 0..SMALL.len() {
        // The last numbers may still be whole without their last digits or line ends.
        let cut = read(&SMALL.as_bytes()[..end]);
        assert!(cut.is_err() || end >= SMALL.len() - 1, "{end}");
    }
    let mut refused = 0;
    for byte in 0..SMALL.len() {
        for bit in 0..8 {
            let mut bytes = SMALL.as_bytes().to_vec();
            bytes[byte] ^= 1 << bit;
            refused += usize::from(read(&bytes).is_err());
        }
    }
    assert!(refused > SMALL.len() * 4, "{refused}");
}

#[test]
fn deep_files_end() {
    let mut text = String::from("HIERARCHY\nROOT a\n");
    for _ in 0..100_000 {
        text.push_str("{ OFFSET 0 0 0 CHANNELS 0 JOINT a ");
    }
    assert_eq!(read(text.as_bytes()), Err(BvhFault::Deep(256)));
}
