use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::*;

const SIZES: [usize; 3] = [1, 2, 4];
const COUNTS: [usize; 6] = [1, 2, 3, 4, 3, 4];

fn picture(width: usize, height: usize, row_bytes: isize, sample: i32, channels: i32) -> Picture {
    Picture { struct_size: size_of::<Picture>(), data: std::ptr::null(), width, height, row_bytes, sample, channels }
}

/// The layout in integers that hold every product, or the code of the refusal.
fn expected(picture: &Picture) -> std::result::Result<(usize, usize), crate::Code> {
    let unknown = crate::Code::UnknownValue;
    let size = usize::try_from(picture.sample).ok().and_then(|sample| SIZES.get(sample)).ok_or(unknown)?;
    let count = usize::try_from(picture.channels).ok().and_then(|channels| COUNTS.get(channels)).ok_or(unknown)?;
    let row = picture.width as i128 * (size * count) as i128;
    let apart = picture.row_bytes as i128;
    let bytes = if picture.height == 0 { 0 } else { (picture.height as i128 - 1) * apart + row };
    if apart < row || bytes > isize::MAX as i128 {
        return Err(crate::Code::Layout);
    }
    Ok((usize::try_from(apart).unwrap(), usize::try_from(bytes).unwrap()))
}

#[test]
fn any_numbers_are_laid_out_right_or_refused() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..50_000 {
        // Of every magnitude, so that products fall on both sides of the limit.
        let mut number = || random.next_u64() >> (random.next_u32() % 64);
        let (width, height) = (number() as usize, number() as usize);
        let row_bytes = match number() % 4 {
            0 => number() as isize,
            1 => (number() as isize).wrapping_neg(),
            _ => width.wrapping_mul(4).wrapping_add((number() % 9) as usize) as isize,
        };
        let (sample, channels) = ((number() % 5) as i32 - 1, (number() % 8) as i32 - 1);
        let picture = picture(width, height, row_bytes, sample, channels);
        let found = Layout::of(&picture).map(|layout| (layout.row_bytes, layout.bytes)).map_err(|error| error.code());
        assert_eq!(found, expected(&picture), "{picture:?}");
        *(if found.is_ok() { &mut taken } else { &mut refused }) += 1;
    }
    assert!(taken > 1000 && refused > 1000, "{taken} {refused}");
}

#[test]
fn refusals_carry_their_numbers() {
    let text = |picture: &Picture| Layout::of(picture).unwrap_err().to_string();
    assert_eq!(
        text(&picture(640, 480, -1920, 0, 4)),
        "mb_picture.row_bytes = -1920 is not allowed: rows of 640 pixels take 1920 bytes"
    );
    assert_eq!(
        text(&picture(640, usize::MAX, 640, 0, 0)),
        format!("a picture of 640x{} pixels with rows 640 bytes apart is larger than any memory", usize::MAX)
    );
    assert_eq!(
        text(&picture(640, 480, 640, 9, 0)),
        "mb_picture.sample = 9 is not allowed: it must be 0 to 2, see mb_sample"
    );
}
