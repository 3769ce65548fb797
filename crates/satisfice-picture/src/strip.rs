//! Pictures side by side.

use tiny_skia::{Pixmap, PixmapPaint, Transform};

use crate::error::Error;

/// Pictures of one size as PNG, `columns` of them in a row, as one PNG.
///
/// # Errors
/// [`Error::Picture`] without pictures or columns, for bytes that are not PNG, or for a strip that is too large.
pub fn strip(pictures: &[Vec<u8>], columns: usize) -> Result<Vec<u8>, Error> {
    let bad = |what: String| Error::Picture(what);
    let maps = pictures
        .iter()
        .map(|png| Pixmap::decode_png(png).map_err(|error| bad(error.to_string())))
        .collect::<Result<Vec<_>, _>>()?;
    let (Some(first), true) = (maps.first(), columns > 0) else {
        return Err(bad(
            "a strip of nothing: give at least one picture and one column".to_owned(),
        ));
    };
    let (width, height) = (first.width(), first.height());
    let rows = maps.len().div_ceil(columns);
    let size = |pixels: u32, count: usize| {
        u32::try_from(count)
            .ok()
            .and_then(|count| pixels.checked_mul(count))
    };
    let whole = size(width, columns.min(maps.len())).zip(size(height, rows));
    let mut strip = whole
        .and_then(|(width, height)| Pixmap::new(width, height))
        .ok_or_else(|| bad(format!("a strip of {} pictures is too large", maps.len())))?;
    for (place, map) in maps.iter().enumerate() {
        #[expect(
            clippy::cast_possible_wrap,
            clippy::cast_possible_truncation,
            reason = "the whole strip fits"
        )]
        let at = |pixels: u32, count: usize| (pixels as usize * count) as i32;
        let (x, y) = (at(width, place % columns), at(height, place / columns));
        strip.draw_pixmap(
            x,
            y,
            map.as_ref(),
            &PixmapPaint::default(),
            Transform::identity(),
            None,
        );
    }
    strip.encode_png().map_err(|error| bad(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Picture, View};

    #[test]
    fn pictures_stand_side_by_side() {
        let ball = satisfice_collision::generate::icosphere(1.0, 1).unwrap();
        let mut picture = Picture::new(40, 30, View::default());
        picture.body(&ball);
        let png = picture.png().unwrap();
        let one = Pixmap::decode_png(&png).unwrap();
        let whole = Pixmap::decode_png(&strip(&vec![png; 3], 2).unwrap()).unwrap();
        assert_eq!((whole.width(), whole.height()), (80, 60));
        for (x, y) in [(0, 0), (20, 15), (39, 29)] {
            assert_eq!(whole.pixel(x + 40, y), one.pixel(x, y));
            assert_eq!(whole.pixel(x, y + 30), one.pixel(x, y));
        }
        assert!(strip(&[], 2).is_err() && strip(&[vec![1, 2]], 2).is_err());
    }
}
