//! What compositors rely on: contributions combine in any grouping, order-free ones in any order, nothing changes nothing.

use cellfan::optics::{
    Absorption, BandCells, BandDepths, BandLight, BandTable, Emission, EmissionAbsorption, Mip, Optics, Output,
};
use proptest::prelude::*;

use crate::meshes::smooth;

fn close(a: [f32; 4], b: [f32; 4]) -> bool {
    a.iter().zip(&b).all(|(a, b)| a == b || (a - b).abs() <= 1e-5 * (1.0 + a.abs()))
}

fn check<O: Optics>(a: [f32; 4], b: [f32; 4], c: [f32; 4]) {
    assert!(close(O::over(O::over(a, b), c), O::over(a, O::over(b, c))), "{a:?} {b:?} {c:?}");
    assert_eq!(O::over(O::CLEAR, a), a);
    assert_eq!(O::over(a, O::CLEAR), a);
    assert_eq!(O::transmittance(O::CLEAR), 1.0);
    if !O::IS_ORDERED {
        assert_eq!(O::over(a, b), O::over(b, a));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(11), ..ProptestConfig::default() })]

    #[test]
    fn contributions_are_monoids(x in prop::array::uniform12(0.0_f32..1.0)) {
        let [a, b, c] = [0, 4, 8].map(|i| [x[i], x[i + 1], x[i + 2], x[i + 3]]);
        check::<EmissionAbsorption>(a, b, c);
        check::<Absorption>(a, b, c);
        check::<Emission>(a, b, c);
        check::<BandCells>(a, b, c);
        check::<BandDepths>(a, b, c);
        check::<BandLight>(a, b, c);
        // Only the first number of a maximum means anything.
        let [a, b, c] = [a, b, c].map(|[s, ..]| [s, 0.0, 0.0, 0.0]);
        check::<Mip>(a, b, c);
    }
}

#[test]
fn nothing_is_a_miss() {
    let pieces = smooth().pieces(0.0);
    let pieces = &pieces;
    assert_eq!(EmissionAbsorption { pieces }.pixel(EmissionAbsorption::CLEAR), [0.0; 4]);
    assert_eq!(Emission { pieces }.pixel(Emission::CLEAR), [0.0; 4]);
    assert_eq!(Mip { pieces }.pixel(Mip::CLEAR), [0.0; 4]);
    for output in Output::ALL {
        assert_eq!(Absorption { pieces, output }.pixel(Absorption::CLEAR), [output.miss(); 4]);
        let passes = BandTable::constant(vec![1.0; 5]).unwrap().passes(0.0).passes;
        assert_eq!(passes.len(), 2);
        assert_eq!(BandDepths { pieces: &passes[1], output }.pixel(BandDepths::CLEAR), [output.miss(); 4]);
        assert_eq!(BandCells { columns: &[], output }.pixel(BandCells::CLEAR), [output.miss(); 4]);
        assert_eq!(BandLight { pieces: &passes[1] }.pixel(BandLight::CLEAR), [0.0; 4]);
    }
}
