//! Material libraries of OBJ files: of each material its diffuse colour, and the texture of it.

use std::collections::HashMap;

use pointstage_plugin_api::lines::{Lines, number};

/// What a material library says.
#[derive(Debug, Default)]
pub(crate) struct Materials {
    /// By name.
    pub(crate) all: HashMap<Vec<u8>, Described>,
}

/// One material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Described {
    /// Diffuse colour, sRGB, 0 to 1.
    pub(crate) diffuse: Option<[f32; 3]>,
    pub(crate) texture: Option<Texture>,
}

/// A texture, as `map_Kd` has it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Texture {
    /// The file's name as written.
    pub(crate) name: String,
    /// What texture coordinates are multiplied by.
    pub(crate) scale: [f32; 2],
    /// What is added to them then.
    pub(crate) offset: [f32; 2],
    /// Whether the picture ends at its rim; it repeats otherwise.
    pub(crate) is_clamped: bool,
}

impl Materials {
    /// Adds the materials of a library. Lines that it does not understand say nothing of colours, and are skipped.
    pub(crate) fn read(&mut self, text: &[u8]) {
        let mut current: Option<&mut Described> = None;
        for line in Lines::new(text) {
            let mut words = line.words();
            let keyword = words.next();
            if keyword == Some(b"newmtl") {
                let name = rest_of(line.text, b"newmtl").to_vec();
                current = Some(self.all.entry(name).or_default());
                continue;
            }
            let Some(material) = &mut current else {
                continue;
            };
            match keyword {
                Some(b"Kd") => {
                    let colour: Vec<f32> =
                        words.map_while(number).map(|value| value as f32).collect();
                    if let [red, green, blue, ..] = colour.as_slice() {
                        material.diffuse = Some([*red, *green, *blue]);
                    }
                }
                Some(b"map_Kd") => {
                    material.texture = Texture::parse(rest_of(line.text, b"map_Kd"));
                }
                _ => {}
            }
        }
    }
}

impl Texture {
    /// Options, each with its values, then the name, which may hold blanks; `None` if there is no name.
    fn parse(mut text: &[u8]) -> Option<Self> {
        let mut found = Self {
            name: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
        };
        while text.starts_with(b"-") {
            let (option, mut rest) = split_word(text);
            let vector = matches!(option, b"-s" | b"-o" | b"-t");
            let least = match option {
                b"-s" | b"-o" | b"-t" | b"-blendu" | b"-blendv" | b"-cc" | b"-clamp"
                | b"-imfchan" | b"-texres" | b"-boost" | b"-bm" | b"-type" => 1,
                b"-mm" => 2,
                // A name that begins with a dash.
                _ => break,
            };
            let mut values: Vec<&[u8]> = Vec::new();
            // Of a vector the second and third value may be missing.
            while values.len() < least || (vector && values.len() < 3) {
                let (value, behind) = split_word(rest);
                let is_needed = values.len() < least;
                if value.is_empty() || (!is_needed && number(value).is_none()) {
                    break;
                }
                values.push(value);
                rest = behind;
            }
            let value = |index: usize| values.get(index).and_then(|word| number(word));
            match option {
                b"-s" => {
                    found.scale = [value(0).unwrap_or(1.0), value(1).unwrap_or(1.0)]
                        .map(|value| value as f32);
                }
                b"-o" => {
                    found.offset = [value(0).unwrap_or(0.0), value(1).unwrap_or(0.0)]
                        .map(|value| value as f32);
                }
                b"-clamp" => found.is_clamped = values.first() == Some(&&b"on"[..]),
                _ => {}
            }
            text = rest;
        }
        String::from_utf8_lossy(text)
            .trim()
            .clone_into(&mut found.name);
        (!found.name.is_empty()).then_some(found)
    }

    /// Where the texture coordinates of a corner lie on the picture, v from its top.
    pub(crate) fn place(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let [u, v] = [
            u * self.scale[0] + self.offset[0],
            v * self.scale[1] + self.offset[1],
        ];
        [u, 1.0 - v]
    }
}

/// The first word, and what stands behind it.
fn split_word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace);
    let (word, rest) = text.split_at(end.unwrap_or(text.len()));
    (word, rest.trim_ascii_start())
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
    fn materials_keep_their_diffuse_colour_and_texture() {
        let mut materials = Materials::default();
        materials.read(
            b"Kd 1 1 1\nnewmtl red paint\n Ka 0 0 0\n Kd 1 0.5 0\nnewmtl none\nmap_Kd my a.png\nKd x 1 1\nmap_Bump b.png\n",
        );
        let red = &materials.all[&b"red paint"[..]];
        assert_eq!((red.diffuse, &red.texture), (Some([1.0, 0.5, 0.0]), &None));
        let none = &materials.all[&b"none"[..]];
        assert_eq!(none.diffuse, None);
        let texture = none.texture.as_ref().unwrap();
        assert_eq!(
            (texture.name.as_str(), texture.place([0.25, 0.25])),
            ("my a.png", [0.25, 0.75])
        );
        assert_eq!(materials.all.len(), 2);
    }

    #[test]
    fn options_stand_before_the_name() {
        let parse = |text: &str| Texture::parse(text.as_bytes());
        let all = parse("-s 2 3 1 -o 0.5 -clamp on -mm 0 1 -bm 1 folder\\a b.png").unwrap();
        assert_eq!(all.name, "folder\\a b.png");
        assert_eq!(
            (all.scale, all.offset, all.is_clamped),
            ([2.0, 3.0], [0.5, 0.0], true)
        );
        assert_eq!(parse("-s 2 a.png").unwrap().scale, [2.0, 1.0]);
        assert_eq!(parse("-odd.png").unwrap().name, "-odd.png");
        assert_eq!(parse("-clamp on"), None);
        assert_eq!(parse(""), None);
    }
}
