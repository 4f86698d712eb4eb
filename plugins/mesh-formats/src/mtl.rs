//! Material libraries of OBJ files: of each material its diffuse colour.

use std::collections::HashMap;

use pointstage_plugin_api::lines::{Lines, number};

/// What a material library says.
#[derive(Debug, Default)]
pub(crate) struct Materials {
    /// Diffuse colours by name, 0 to 1.
    pub(crate) diffuse: HashMap<Vec<u8>, [f32; 3]>,
    /// Materials with a texture of the diffuse colour.
    pub(crate) textured: u64,
}

impl Materials {
    /// Adds the materials of a library. Lines that it does not understand say nothing of colours, and are skipped.
    pub(crate) fn read(&mut self, text: &[u8]) {
        let mut current: Option<Vec<u8>> = None;
        for line in Lines::new(text) {
            let mut words = line.words();
            match words.next() {
                Some(b"newmtl") => current = Some(rest_of(line.text, b"newmtl").to_vec()),
                Some(b"Kd") => {
                    let colour: Vec<f32> =
                        words.map_while(number).map(|value| value as f32).collect();
                    if let (Some(name), [red, green, blue, ..]) = (&current, colour.as_slice()) {
                        self.diffuse.insert(name.clone(), [*red, *green, *blue]);
                    }
                }
                Some(b"map_Kd") => self.textured += 1,
                _ => {}
            }
        }
    }
}

/// What stands behind a line's keyword, without space around it.
pub(crate) fn rest_of<'a>(line: &'a [u8], keyword: &[u8]) -> &'a [u8] {
    let line = line.trim_ascii();
    line.strip_prefix(keyword).unwrap_or_default().trim_ascii()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_keep_their_diffuse_colour() {
        let mut materials = Materials::default();
        materials.read(
            b"newmtl red paint\n Ka 0 0 0\n Kd 1 0.5 0\nnewmtl none\nmap_Kd a.png\nKd x 1 1\n",
        );
        assert_eq!(
            materials.diffuse.get(&b"red paint"[..]),
            Some(&[1.0, 0.5, 0.0])
        );
        assert_eq!((materials.diffuse.len(), materials.textured), (1, 1));
    }
}
