/// Where a function with one minimum between 0 and 1 is least, and its least value, by so many steps of the golden section search:
/// each leaves 0.618 of the interval.
///
/// ```
/// let (at, least) = whipcord_numerics::golden_section(40, |x| (x - 0.3).abs() + 2.0);
/// assert!((at - 0.3).abs() < 1e-8 && (least - 2.0).abs() < 1e-8);
/// ```
pub fn golden_section(steps: usize, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (0.0, 1.0);
    let mut inner = [1.0 - GOLDEN, GOLDEN];
    let mut values = inner.map(&f);
    for _ in 0..steps {
        if values[0] <= values[1] {
            high = inner[1];
            inner = [high - GOLDEN * (high - low), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + GOLDEN * (high - low)];
            values = [values[1], f(inner[1])];
        }
    }
    if values[0] <= values[1] { (inner[0], values[0]) } else { (inner[1], values[1]) }
}
