//! Checks of `[growth]` that need no mesh.

use crate::growth::maps::SCALAR_MAPS;
use crate::scene::hold::{Grip, check_axes};
use crate::scene::maps::procedure;
use crate::scene::schema::{
    AxisKind, BandTable, CountTable, DirectionTable, ExpansionTable, FreezeTable, GrowthTable,
    MapKind, MapTable, ProcedureTable, Scene,
};
use crate::scene::value::{direction, in_reach, not_blank, not_blank_path, positive, within};
use crate::{Error, Result};

/// Most steps one may ask for.
const MOST_STEPS: usize = 10_000;

pub(in crate::scene) fn check(scene: &Scene, table: &GrowthTable) -> Result<()> {
    if table.expansion.is_empty() {
        return Err(Error::value(
            "growth.expansion",
            "nothing says how much it grows; add a [[growth.expansion]] with a factor",
        ));
    }
    for (i, expansion) in table.expansion.iter().enumerate() {
        check_expansion(scene, &format!("growth.expansion[{i}]"), expansion)?;
    }
    for map in &SCALAR_MAPS {
        if let Some(table) = table.scalar_map(map.name) {
            check_map(scene, &format!("growth.{}", map.name), table)?;
        }
    }
    for (i, band) in table.band.iter().enumerate() {
        check_band(scene, &format!("growth.band[{i}]"), band)?;
    }
    for (i, freeze) in table.freeze.iter().enumerate() {
        check_freeze(scene, &format!("growth.freeze[{i}]"), freeze)?;
    }
    for (i, count) in table.count.iter().enumerate() {
        check_count(scene, &format!("growth.count[{i}]"), count)?;
        if let Some(j) = table.count[..i].iter().position(|other| other.name == count.name) {
            let message = format!(
                "growth.count[{j}] is called \"{}\", too; give each a name of its own",
                count.name
            );
            return Err(Error::value(format!("growth.count[{i}].name"), message));
        }
    }
    within("growth.steps", table.steps, 1, MOST_STEPS)?;
    within("growth.iteration_limit", table.iteration_limit, 1, 1_000_000)?;
    within(
        "growth.remesh.finish_iterations",
        table.remesh.as_ref().and_then(|remesh| remesh.finish_iterations),
        1,
        1_000_000,
    )?;
    for (name, value) in [("plasticity", table.plasticity), ("imperfection", table.imperfection)] {
        if let Some(value) = value
            && !(0.0..=1.0).contains(&value)
        {
            return Err(Error::value(
                format!("growth.{name}"),
                format!("{value} is no share; give a number from 0 to 1"),
            ));
        }
    }
    Ok(())
}

fn check_expansion(scene: &Scene, place: &str, table: &ExpansionTable) -> Result<()> {
    if let Some(panel) = &table.panel
        && !scene.panel.iter().any(|p| p.name == *panel)
    {
        return Err(scene.no_panel(&format!("{place}.panel"), panel));
    }
    for (name, map) in [("factor", &table.factor), ("across", &table.across)] {
        if let Some(map) = map {
            check_map(scene, &format!("{place}.{name}"), map)?;
        }
    }
    match &table.direction {
        Some(DirectionTable::Fixed(d)) => {
            direction(&format!("{place}.direction"), *d)?;
        }
        Some(DirectionTable::Axis(table)) => {
            in_reach(&format!("{place}.direction.centre_m"), &table.centre_m)?;
            match (table.kind, table.axis, &table.names) {
                (AxisKind::Attribute, None, Some(names)) => {
                    for name in names {
                        not_blank(&format!("{place}.direction.names"), name)?;
                    }
                }
                (AxisKind::Attribute, ..) => {
                    let message = "this kind needs names, and no axis; give the three attributes \
                        that are the direction's x, y and z";
                    return Err(Error::value(format!("{place}.direction"), message));
                }
                (_, Some(axis), None) => {
                    direction(&format!("{place}.direction.axis"), axis)?;
                }
                _ => {
                    return Err(Error::value(
                        format!("{place}.direction"),
                        "this kind needs an axis, and no names; give [x, y, z]",
                    ));
                }
            }
        }
        None if table.across.is_some() || table.tensor.is_some() => {
            return Err(Error::value(
                format!("{place}.direction"),
                "this is missing; say along which direction, or give a factor only",
            ));
        }
        None => {}
    }
    match (&table.factor, &table.tensor) {
        (None, None) => Err(Error::value(
            format!("{place}.factor"),
            "this is missing; give a factor of length, or a tensor",
        )),
        (Some(_), Some(_)) => Err(Error::value(
            format!("{place}.tensor"),
            "the factor says how much it grows already; remove one of them",
        )),
        (None, Some(_)) if table.across.is_some() => Err(Error::value(
            format!("{place}.across"),
            "the tensor says how much it grows across already; remove one of them",
        )),
        (_, Some(tensor)) => {
            tensor.iter().try_for_each(|map| check_map(scene, &format!("{place}.tensor"), map))
        }
        _ => Ok(()),
    }
}

fn check_freeze(scene: &Scene, place: &str, table: &FreezeTable) -> Result<()> {
    check_axes(place, &table.axes)?;
    let others = table.side.is_some() || table.near_m.is_some() || table.within_m.is_some();
    match &table.map {
        Some(_) if others => Err(Error::value(
            place,
            "this says where in several ways; keep one of side, near_m, within_m and map",
        )),
        Some(map) => check_map(scene, &format!("{place}.map"), map),
        None if !others => Err(Error::value(
            place,
            "this does not say where; give one of side, near_m, within_m and map",
        )),
        None => Grip::new(place, table.side.as_deref(), table.near_m, table.within_m)?
            .check(scene, place),
    }
}

fn check_band(scene: &Scene, place: &str, table: &BandTable) -> Result<()> {
    match (&table.map, table.side.is_some() || table.within_m.is_some()) {
        (Some(_), true) => Err(Error::value(
            place,
            "this says where in several ways; keep one of side, within_m and map",
        )),
        (Some(map), false) => check_map(scene, &format!("{place}.map"), map),
        (None, false) => {
            Err(Error::value(place, "this does not say where; give one of side, within_m and map"))
        }
        (None, true) => {
            Grip::new(place, table.side.as_deref(), None, table.within_m)?.check(scene, place)
        }
    }
}

fn check_count(scene: &Scene, place: &str, table: &CountTable) -> Result<()> {
    not_blank(&format!("{place}.name"), &table.name)?;
    let Some(panel) = scene.panel.iter().find(|p| p.name == table.panel) else {
        return Err(scene.no_panel(&format!("{place}.panel"), &table.panel));
    };
    let ring = table.centre_m.is_some() || table.radius_m.is_some() || table.width_m.is_some();
    match (ring, table.low_m, table.high_m) {
        (false, None, None) if panel.shape.closed() => Ok(()),
        (true, ..) if panel.shape.closed() => Err(Error::value(
            place,
            "a closed panel has no rings in a plane; give low_m and high_m, or neither for all \
             around it",
        )),
        (false, Some(low), Some(high)) => {
            in_reach(&format!("{place}.low_m"), &low)?;
            in_reach(&format!("{place}.high_m"), &high)?;
            if (0..2).any(|axis| low[axis] >= high[axis]) {
                return Err(Error::value(
                    format!("{place}.high_m"),
                    "it is not above and right of low_m; give the upper right corner",
                ));
            }
            Ok(())
        }
        (true, None, None) => {
            let (Some(centre), Some(radius), Some(width)) =
                (table.centre_m, table.radius_m, table.width_m)
            else {
                return Err(Error::value(
                    place,
                    "a ring needs centre_m, radius_m and width_m; give all three",
                ));
            };
            in_reach(&format!("{place}.centre_m"), &centre)?;
            positive(&format!("{place}.radius_m"), radius)?;
            if positive(&format!("{place}.width_m"), width)? >= 2.0 * radius {
                return Err(Error::value(
                    format!("{place}.width_m"),
                    "the ring is wider than it is large; give less than twice its radius",
                ));
            }
            if table.along.is_some() {
                return Err(Error::value(
                    format!("{place}.along"),
                    "on a ring folds are counted around it; remove this",
                ));
            }
            Ok(())
        }
        _ => Err(Error::value(
            place,
            "this does not say where; give low_m and high_m for a rectangle, or centre_m, radius_m \
             and width_m for a ring",
        )),
    }
}

fn check_map(scene: &Scene, place: &str, map: &MapTable) -> Result<()> {
    match map {
        MapTable::Number(value) => in_reach(place, &[*value]),
        MapTable::ProceduralMap(table) => {
            check_fields(place, table)?;
            in_reach(&format!("{place}.low"), &[table.low])?;
            in_reach(&format!("{place}.high"), &[table.high])?;
            let points =
                [("from_m", &table.from_m), ("to_m", &table.to_m), ("centre_m", &table.centre_m)];
            for (name, point) in points {
                in_reach(&format!("{place}.{name}"), point.as_ref().map_or(&[][..], |p| &p[..]))?;
            }
            for point in table.centres_m.iter().flatten() {
                in_reach(&format!("{place}.centres_m"), point)?;
            }
            if let Some(file) = &table.file {
                not_blank_path(&format!("{place}.file"), file)?;
            }
            if let Some(shares) = &table.shares {
                let count = scene.panel.len();
                if shares.len() != count {
                    let message = format!(
                        "it has {} values for {count} panels; give one for each, in the scene's \
                         order",
                        shares.len()
                    );
                    return Err(Error::value(format!("{place}.shares"), message));
                }
                if let Some(share) = shares.iter().find(|share| !(0.0..=1.0).contains(*share)) {
                    return Err(Error::value(
                        format!("{place}.shares"),
                        format!("{share} is no share; give numbers from 0 to 1"),
                    ));
                }
            }
            procedure(table).map_or(Ok(()), |procedure| procedure.check(place))
        }
    }
}

/// Fields that the kind must have, and that it must not.
fn check_fields(place: &str, t: &ProcedureTable) -> Result<()> {
    use MapKind::{Attribute, Band, Fractal, Image, Noise, Panels, Radial, Ramp, Ring, Spots};
    let fields: [(&str, bool, &[MapKind], bool); 15] = [
        ("from_m", t.from_m.is_some(), &[Ramp], true),
        ("to_m", t.to_m.is_some(), &[Ramp], true),
        ("centre_m", t.centre_m.is_some(), &[Band, Ring, Radial], true),
        ("centres_m", t.centres_m.is_some(), &[Spots], true),
        ("normal", t.normal.is_some(), &[Band], true),
        ("axis", t.axis.is_some(), &[Ring, Radial], true),
        ("radius_m", t.radius_m.is_some(), &[Ring, Radial, Spots], true),
        ("width_m", t.width_m.is_some(), &[Band, Ring], true),
        ("soft_m", t.soft_m.is_some(), &[Band, Ring], false),
        ("size_m", t.size_m.is_some(), &[Noise, Fractal], true),
        ("octaves", t.octaves.is_some(), &[Fractal], true),
        ("seed", t.seed.is_some(), &[Noise, Fractal], false),
        ("file", t.file.is_some(), &[Image], true),
        ("shares", t.shares.is_some(), &[Panels], true),
        ("name", t.name.is_some(), &[Attribute], true),
    ];
    let kind = format!("{:?}", t.kind).to_lowercase();
    for (name, given, kinds, required) in fields {
        let has = kinds.contains(&t.kind);
        if given && !has {
            return Err(Error::value(
                format!("{place}.{name}"),
                format!("the kind \"{kind}\" has no such field; remove it"),
            ));
        }
        if has && required && !given {
            let needed: Vec<&str> =
                fields.iter().filter(|f| f.3 && f.2.contains(&t.kind)).map(|f| f.0).collect();
            let message =
                format!("this is missing; the kind \"{kind}\" needs {}", needed.join(", "));
            return Err(Error::value(format!("{place}.{name}"), message));
        }
    }
    Ok(())
}
