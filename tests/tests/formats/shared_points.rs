//! Every point cloud of the shared test data folder: counts, boxes and spot values as its README and its manifest say.

use anyhow::{Context as _, Result};
use pointstage_scene::{Loaded, Provenance};
use pointstage_tests::data::shared;
use pointstage_tests::loaders::{first_party, load_as_it_is};

/// Asserts count and box, to half a step of the file's scale.
fn check(loaded: &Loaded, count: usize, min: [f64; 3], max: [f64; 3], scale: f64) {
    assert_eq!(loaded.object.geometry.surfel_count, count);
    let bounds = loaded.object.bounds_world();
    for axis in 0..3 {
        let (low, high) = (bounds.min.to_array()[axis], bounds.max.to_array()[axis]);
        assert!(
            (low - min[axis]).abs() < scale / 2.0,
            "{low} is not {}",
            min[axis]
        );
        assert!(
            (high - max[axis]).abs() < scale / 2.0,
            "{high} is not {}",
            max[axis]
        );
    }
}

/// The least and the greatest value of a named column.
fn range(loaded: &Loaded, name: &str) -> Option<[f64; 2]> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for block in &loaded.object.geometry.blocks {
        let column = block.named.iter().find(|column| &*column.name == name)?;
        for value in (0..block.len()).filter_map(|surfel| column.value(surfel, 0)) {
            range = [range[0].min(value), range[1].max(value)];
        }
    }
    Some(range)
}

#[test]
fn the_indoor_scan_has_no_colour_worth_the_name() -> Result<()> {
    let Some(path) = shared("points/indoor_808k.laz") else {
        return Ok(());
    };
    let loaded = load_as_it_is(&first_party()?, &path)?;
    assert_eq!(loaded.loader.alias, "las");
    check(
        &loaded,
        808_042,
        [-22.99, -1.97, -7.9],
        [5.63, 7.55, 12.36],
        0.01,
    );
    assert_eq!(loaded.object.geometry.origins.colours, Provenance::Missing);
    assert_eq!(range(&loaded, "intensity"), Some([0.0, 0.0]));
    assert_eq!(range(&loaded, "classification"), Some([0.0, 0.0]));
    Ok(())
}

#[test]
fn the_terrain_keeps_its_map_coordinates_and_its_16_bit_colours() -> Result<()> {
    let Some(path) = shared("points/vol_total_rgb_499k.laz") else {
        return Ok(());
    };
    let loaded = load_as_it_is(&first_party()?, &path)?;
    check(
        &loaded,
        498_868,
        [589_500.0, 231_300.0, 722.55],
        [590_099.99, 231_565.7, 789.9],
        0.01,
    );
    let blocks = loaded.object.geometry.blocks.iter();
    let colours = blocks.flat_map(|block| block.colour.iter().flat_map(|column| column.iter()));
    let brightest = colours.fold([0; 3], |most: [u8; 3], colour| {
        let [red, green, blue, _] = colour.to_le_bytes();
        [most[0].max(red), most[1].max(green), most[2].max(blue)]
    });
    assert_eq!(brightest, [255; 3]);
    // f32 around the object's origin: a step far below that of the file.
    let extent = loaded.object.geometry.bounds.size().max_element();
    assert!(extent * f64::from(f32::EPSILON) < 0.001, "{extent}");
    assert!(loaded.object.origin.length() > 500_000.0);
    Ok(())
}

#[test]
fn the_copc_file_opens_at_full_resolution() -> Result<()> {
    let Some(path) = shared("points/lone-star.copc.laz") else {
        return Ok(());
    };
    let loaded = load_as_it_is(&first_party()?, &path)?;
    let min = [515_368.602_25, 4_918_340.364, 2_322.896_25];
    let max = [515_401.043, 4_918_381.123_75, 2_338.575_5];
    check(&loaded, 518_862, min, max, 0.000_25);
    assert_eq!(range(&loaded, "intensity"), Some([17.0, 2744.0]));
    assert!(loaded.object.geometry.blocks[0].colour.is_none());
    assert!(
        range(&loaded, "gps_time").is_some_and(|[least, most]| least >= 0.0 && most.is_finite())
    );
    Ok(())
}

#[test]
fn e57_scans_have_as_many_points_as_they_say() -> Result<()> {
    let loaders = first_party()?;
    for (name, count, has_colour) in [
        ("bunnyDouble.e57", 30_571, false),
        ("tinyCartesianFloatRgb.e57", 2_090, true),
        // Of 360 points every other one is marked as a direction without a distance.
        ("tiny_spherical.e57", 180, false),
        ("tiny_pc_and_images.e57", 2, false),
    ] {
        let Some(path) = shared(&format!("points/{name}")) else {
            return Ok(());
        };
        let loaded = load_as_it_is(&loaders, &path).with_context(|| name.to_owned())?;
        assert_eq!(loaded.loader.alias, "e57", "{name}");
        let geometry = &loaded.object.geometry;
        assert_eq!(geometry.surfel_count, count, "{name}");
        assert_eq!(geometry.blocks[0].colour.is_some(), has_colour, "{name}");
        let size = geometry.bounds.size().max_element();
        assert!(size.is_finite() && size > 0.0, "{name}: {size}");
        let left_out = loaded
            .warnings
            .iter()
            .map(|warning| warning.count)
            .sum::<u64>();
        assert_eq!(
            left_out,
            if name == "tiny_spherical.e57" { 180 } else { 0 },
            "{name}"
        );
    }
    Ok(())
}

#[test]
fn e57_files_without_points_or_with_a_wrong_checksum_are_refused() -> Result<()> {
    let loaders = first_party()?;
    for (name, part) in [
        ("empty_pc.e57", "1 scans with 0 points"),
        ("corrupt_crc.e57", "invalid checksum"),
    ] {
        let Some(path) = shared(&format!("points/{name}")) else {
            return Ok(());
        };
        let error = load_as_it_is(&loaders, &path);
        let error = error
            .err()
            .with_context(|| format!("{name} was taken"))?
            .to_string();
        assert!(error.contains(part) && error.contains(name), "{error}");
    }
    Ok(())
}

#[test]
fn what_is_not_read_is_refused_by_its_name() -> Result<()> {
    let loaders = first_party()?;
    for (name, part) in [
        ("step/cube_hole_ap214.step", "this is a STEP file"),
        ("step/ventilator_ap203.stp", "this is a STEP file"),
        ("gsplat/fourth_st_131k_sh3.spz", "this is an SPZ file"),
        (
            "gsplat/guitar_91k.compressed.ply",
            "compressed Gaussian splat",
        ),
    ] {
        let Some(path) = shared(name) else {
            return Ok(());
        };
        let error = load_as_it_is(&loaders, &path);
        let error = error
            .err()
            .with_context(|| format!("{name} was taken"))?
            .to_string();
        assert!(error.contains(part), "{error}");
    }
    Ok(())
}
