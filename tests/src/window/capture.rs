//! Pictures of the display.

use anyhow::{Result, bail, ensure};
use image::RgbaImage;
use x11rb::protocol::xproto::{ConnectionExt as _, ImageFormat, Window};
use x11rb::rust_connection::RustConnection;

/// All of the display, opaque.
pub(super) fn capture(connection: &RustConnection, root: Window) -> Result<RgbaImage> {
    let size = connection.get_geometry(root)?.reply()?;
    let all_planes = u32::MAX;
    let (width, height) = (size.width, size.height);
    let image = connection
        .get_image(ImageFormat::Z_PIXMAP, root, 0, 0, width, height, all_planes)?
        .reply()?;
    ensure!(
        image.depth == 24,
        "the display has {} bits a pixel, expected 24",
        image.depth
    );
    // Xvfb keeps 24 bits in four bytes: blue, green, red, unused.
    let rgba = image
        .data
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[2], pixel[1], pixel[0], 255])
        .collect();
    match RgbaImage::from_raw(u32::from(width), u32::from(height), rgba) {
        Some(picture) => Ok(picture),
        None => bail!(
            "{} bytes do not make {width}×{height} pixels",
            image.data.len()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::Display;
    use image::Rgba;
    use x11rb::connection::Connection as _;
    use x11rb::protocol::xproto::{CreateGCAux, Rectangle};

    #[test]
    fn what_is_drawn_on_the_display_is_in_the_picture() {
        let Some(display) = Display::start(64, 48).unwrap() else {
            return;
        };
        let (connection, screen) = x11rb::connect(Some(display.name())).unwrap();
        let root = connection.setup().roots[screen].root;
        let context = connection.generate_id().unwrap();
        connection
            .create_gc(context, root, &CreateGCAux::new().foreground(0x00ff_8000))
            .unwrap();
        let rectangle = Rectangle {
            x: 10,
            y: 20,
            width: 5,
            height: 5,
        };
        connection
            .poly_fill_rectangle(root, context, &[rectangle])
            .unwrap()
            .check()
            .unwrap();
        let picture = capture(&connection, root).unwrap();
        assert_eq!(picture.dimensions(), (64, 48));
        assert_eq!(picture.get_pixel(12, 22), &Rgba([255, 128, 0, 255]));
        assert_eq!(picture.get_pixel(0, 0), &Rgba([0, 0, 0, 255]));
    }
}
