// GPL-2.0-or-later. How light falls off with distance, cones of spotlights, and the curves that keys ask for.
#include "q3map2/light/sources/falloff.h"

#include "common/error.h"
#include "q3map2/bspfile/light_keys.h"

#include <algorithm>

namespace q3 {

namespace {

/// Intensities beside keys for a polynomial, and quads R G B I, are the light at this distance. Game units.
constexpr double kReferenceDistance = 100;
/// Value of the polynomial of _fifty_percent_distance at _zero_percent_distance, as a multiple of that at 0.
constexpr double kDarkMultiple = 256;
/// Steps in which FiftyPercentCurve makes a polynomial less steep near the light.
constexpr int kSteepnessSteps = 20;
/// Distance scale of the curves of `delay`. Game units.
constexpr double kDelayScale = 128;
/// Smaller values of `wait`, which scales the distances of `delay`, count as this.
constexpr double kLeastWait = 0.001;
/// A curve of _fifty_percent_distance that fades out from the vertex of its polynomial on ends at this many times the
/// vertex's distance.
constexpr double kVertexEnd = 10;

/// constant + linear d + quadratic d^2.
struct Quadratic {
    double constant, linear, quadratic;
    double At(double d) const { return constant + d * (linear + d * quadratic); }
};

/// The polynomial through (0, 1), (fifty, middle) and (zero, kDarkMultiple), by Newton's divided differences.
Quadratic Through(double fifty, double middle, double zero) {
    const double first = (middle - 1) / fifty, second = (kDarkMultiple - middle) / (zero - fifty);
    const double a = (second - first) / zero;
    return {1, first - a * fifty, a};
}

Attenuation FromQuadratic(const Quadratic &q) {
    return {.constant = float(q.constant), .linear = float(q.linear), .quadratic = float(q.quadratic)};
}

/// Makes the light at distance d photons * brightness / q(d).
void SetPolynomial(const Quadratic &q, double brightness, Light &light) {
    light.curve = FalloffCurve::Polynomial;
    light.attenuation = FromQuadratic({q.constant / brightness, q.linear / brightness, q.quadratic / brightness});
}

void SetFiftyPercent(const Entity &entity, Light &light) {
    const double fifty = keys::kFiftyPercent.Number(entity);
    double zero = keys::kZeroPercent.Number(entity);
    if (zero < fifty) // or missing
        zero = 2 * fifty;
    if (zero == fifty)
        throw Error("{}: _fifty_percent_distance and _zero_percent_distance are both {:g}, expected a larger "
                    "_zero_percent_distance",
                    LightLabel(entity), fifty);
    const auto curve = FiftyPercentCurve(fifty, zero, keys::kHardFalloff.Integer(entity) != 0);
    if (!curve)
        throw Error("{}: no curve falls off as _fifty_percent_distance {:g} and _zero_percent_distance {:g} say, "
                    "expected larger distances",
                    LightLabel(entity), fifty, zero);
    light.curve = FalloffCurve::Polynomial;
    light.attenuation = *curve;
}

bool HasPolynomial(const Entity &entity) {
    return keys::kConstantAttn.Given(entity) || keys::kLinearAttn.Given(entity) || keys::kQuadraticAttn.Given(entity);
}

void SetPolynomialOfKeys(const Entity &entity, Light &light) {
    Quadratic q{keys::kConstantAttn.Number(entity), keys::kLinearAttn.Number(entity),
                keys::kQuadraticAttn.Number(entity)};
    if (q.constant == 0 && q.linear == 0 && q.quadratic == 0)
        q.constant = 1;
    SetPolynomial(q, q.At(kReferenceDistance), light);
}

/// Sets the curve of the key `delay`; false: this number has none. Light at distance d, as a fraction of the photons,
/// with D = kDelayScale / wait: 1: D / d; 2: (D / d)^2; 3: 1; 5: 1 / (1 + d / D)^2.
bool SetDelay(const Entity &entity, Light &light, Log &log) {
    const double given = keys::kWait.Number(entity), wait = given > 0 ? std::max(given, kLeastWait) : 1;
    switch (const int delay = keys::kDelay.Integer(entity)) {
    case 1:
        SetPolynomial({0, wait, 0}, kDelayScale, light);
        return true;
    case 2:
        SetPolynomial({0, 0, wait * wait}, kDelayScale * kDelayScale, light);
        return true;
    case 3:
        SetPolynomial({1, 0, 0}, 1, light);
        return true;
    case 5:
        SetPolynomial({kDelayScale * kDelayScale, 2 * kDelayScale * wait, wait * wait}, kDelayScale * kDelayScale,
                      light);
        return true;
    default:
        log.Warn("delay of a light", "{}: delay {} has no counterpart and is not read; {}", LightLabel(entity), delay,
                 delay == 0   ? "for linear falloff use spawnflags 1 and fade"
                 : delay == 4 ? "for least light use _minlight of worldspawn, for light without falloff delay 3"
                              : "expected 1, 2, 3 or 5");
        return false;
    }
}

void WarnUnused(const Entity &entity, const EntityKey &key, bool used, std::string_view why, Log &log) {
    if (key.Given(entity) && key.Number(entity) != 0 && !used)
        log.Warn("key of a light without effect", "{}: {} has no effect {}", LightLabel(entity), key.info.name, why);
}

} // namespace

std::string LightLabel(const Entity &entity) {
    return fmt::format("{} at \"{}\"", entity.ClassName(), entity.Value("origin"));
}

std::optional<Attenuation> FiftyPercentCurve(double fifty, double zero, bool hard) {
    constexpr double kHalfLight = 2; // value of the polynomial at `fifty`, for half of the light at distance 0
    if (fifty < double(kNearestPolynomial))
        return std::nullopt;
    const double straight = 1 + (kDarkMultiple - 1) * fifty / zero; // at `fifty`, on the line from (0, 1) to the end
    Quadratic q = Through(fifty, kHalfLight, zero);
    double middle = kHalfLight;
    for (int step = 1; step <= kSteepnessSteps && q.linear + 2 * q.quadratic < 0; ++step) {
        middle = kHalfLight + (straight - kHalfLight) * step / kSteepnessSteps;
        q = Through(fifty, middle, zero);
    }
    const double scale = kHalfLight / middle; // makes it kHalfLight at `fifty` again
    q = {q.constant * scale, q.linear * scale, q.quadratic * scale};
    Attenuation curve = FromQuadratic(q);
    const double vertex = q.quadratic != 0 ? -q.linear / (2 * q.quadratic) : 0;
    // The polynomial counts at distances from `from` to `to`. Its slope at distance 1 is not negative, so that its
    // least value there is at one of the two.
    double from = 1, to = zero;
    if (hard) {
        constexpr double kFadePart = 0.25; // of the way from `fifty` to `zero`, at its end
        curve.fadeFrom = float((1 - kFadePart) * zero + kFadePart * fifty), curve.end = float(zero);
    } else if (vertex > 0) {
        curve.flatFrom = curve.fadeFrom = float(vertex), curve.end = float(kVertexEnd * vertex);
        from = std::min(from, vertex), to = vertex;
    }
    if (!(q.At(from) > 0 && q.At(to) > 0))
        return std::nullopt;
    return curve;
}

bool SetCurve(const Entity &entity, bool byQuad, Light &light, Log &log) {
    const bool fifty = keys::kFiftyPercent.Number(entity) != 0, polynomial = !fifty && HasPolynomial(entity);
    const bool ends = !fifty && !polynomial && keys::kEndRadius.Number(entity) != 0;
    const std::string_view together = "together with other keys of falloff";
    WarnUnused(entity, keys::kZeroPercent, fifty, "without _fifty_percent_distance", log);
    WarnUnused(entity, keys::kHardFalloff, fifty, "without _fifty_percent_distance", log);
    for (const EntityKey *key : {&keys::kConstantAttn, &keys::kLinearAttn, &keys::kQuadraticAttn})
        WarnUnused(entity, *key, polynomial, "together with _fifty_percent_distance", log);
    WarnUnused(entity, keys::kEndRadius, ends, together, log);
    WarnUnused(entity, keys::kDelay, !fifty && !polynomial && !ends, together, log);
    constexpr double kSquare = kReferenceDistance * kReferenceDistance;
    if (fifty)
        SetFiftyPercent(entity, light);
    else if (polynomial)
        SetPolynomialOfKeys(entity, light);
    else if (ends) {
        light.curve = FalloffCurve::Windowed;
        light.attenuation = {.end = float(keys::kEndRadius.Number(entity))};
        light.photons *= byQuad ? float(kSquare) : 1;
        return byQuad;
    } else if (keys::kDelay.Given(entity) && SetDelay(entity, light, log))
        return true;
    else if (byQuad)
        SetPolynomial({0, 0, 1}, kSquare, light);
    else
        return false;
    return true;
}

bool CountsInBytes(const Entity &entity) {
    std::string_view text = keys::kLight.Text(entity);
    int numbers = 0;
    while (numbers < 3 && TakeNumber(text))
        ++numbers;
    const int delay = keys::kDelay.Given(entity) ? keys::kDelay.Integer(entity) : 0;
    const bool hasDelay = // a number for which SetDelay has a curve
        keys::kEndRadius.Number(entity) == 0 && (delay == 1 || delay == 2 || delay == 3 || delay == 5);
    return numbers == 3 || keys::kFiftyPercent.Number(entity) != 0 || HasPolynomial(entity) || hasDelay;
}

} // namespace q3
