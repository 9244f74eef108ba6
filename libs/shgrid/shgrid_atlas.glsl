// SPDX-License-Identifier: MIT. Sampling of a sparse SH grid in the textures of shgrid_atlas.h: GLSL 1.30, GLSL ES 3.00
// and later. Include shgrid.glsl first. Light is linear, 1.0 is lightmap byte 255. Textures of the atlas are filtered
// linearly, without mipmaps. In ES all samplers and numbers need highp.

struct ShgridAtlas {
    vec3 mins;   // of shgrid_grid: world position of the lowest point
    vec3 cell;   // of shgrid_grid
    vec3 bounds; // of shgrid_grid, as floats
    vec3 bricks; // of shgrid_atlas, as floats
    float entry; // 2^shift of shgrid_atlas
    float limit1; // of shgrid_atlas
    float limit2;
};

// xyz: texture coordinates in the atlas of a world position. w: 1, or 0 where the grid has no light.
vec4 ShgridPlace(usampler3D indirection, ShgridAtlas atlas, vec3 position)
{
    vec3 at = min(max((position - atlas.mins) / atlas.cell, vec3(0.0)), atlas.bounds * 0.999999);
    uvec4 brick = texelFetch(indirection, ivec3(at / atlas.entry), 0);
    vec3 texel = fract(at / exp2(float(brick.w))) * 4.0 + vec3(0.5);
    vec3 place = (vec3(float(brick.x), float(brick.y), float(brick.z)) * 5.0 + texel) / (atlas.bricks * 5.0);
    return vec4(place.x, place.y, place.z, brick.w > 0u ? 1.0 : 0.0);
}

// Light on a surface with that unit normal, from the seven texels of SHGRID_ATLAS_SNORM. Those of SHGRID_ATLAS_HALF are
// in the order of ShgridLightTexels.
vec3 ShgridLightSnorm(ShgridAtlas atlas, vec3 mean, vec4 t1, vec4 t2, vec4 t3, vec4 t4, vec4 t5, vec4 t6, vec3 n)
{
    vec3 band1 = vec3(t1.x, t1.y, t1.z) * (0.488602512 * n.y) + vec3(t1.w, t2.x, t2.y) * (0.488602512 * n.z);
    band1 += vec3(t2.z, t2.w, t3.x) * (0.488602512 * n.x);
    vec3 band2 = vec3(t3.y, t3.z, t3.w) * (1.092548431 * n.x * n.y);
    band2 += vec3(t4.x, t4.y, t4.z) * (1.092548431 * n.y * n.z);
    band2 += vec3(t4.w, t5.x, t5.y) * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    band2 += vec3(t5.z, t5.w, t6.x) * (1.092548431 * n.x * n.z);
    band2 += vec3(t6.y, t6.z, t6.w) * (0.546274215 * (n.x * n.x - n.y * n.y));
    return max(mean * (vec3(0.282094792) + band1 * atlas.limit1 + band2 * atlas.limit2), vec3(0.0));
}

// Light at a world position, SHGRID_ATLAS_HALF.
vec3 ShgridHalf(usampler3D indirection, sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4,
                sampler3D s5, sampler3D s6, ShgridAtlas atlas, vec3 position, vec3 normal)
{
    vec4 at = ShgridPlace(indirection, atlas, position);
    vec3 p = vec3(at.x, at.y, at.z);
    return ShgridLightTexels(textureLod(s0, p, 0.0), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                             textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0),
                             textureLod(s6, p, 0.0), normal) * at.w;
}

// Light at a world position, SHGRID_ATLAS_SNORM.
vec3 ShgridSnorm(usampler3D indirection, sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4,
                 sampler3D s5, sampler3D s6, ShgridAtlas atlas, vec3 position, vec3 normal)
{
    vec4 at = ShgridPlace(indirection, atlas, position);
    vec3 p = vec3(at.x, at.y, at.z);
    vec4 mean = textureLod(s0, p, 0.0);
    return ShgridLightSnorm(atlas, vec3(mean.x, mean.y, mean.z), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                            textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0),
                            textureLod(s6, p, 0.0), normal) * at.w;
}

// ---- lights that the grid names, in the textures of shgrid_atlas_fill_lights ----
// Shares are filtered linearly. Names and the table of lights are read without a filter; shgrid_put_light_ and
// shgrid_put_polygon_ say what is in the texels of the table.

// A texel of the table of lights.
vec4 ShgridRecord(sampler2D table, int number)
{
    return texelFetch(table, ivec2(number % 1024, number / 1024), 0);
}

// Integrals over the solid angle that a light covers: of 1, of w, and of w w^T, w the unit direction.
struct ShgridMoments {
    float solidAngle;
    vec3 first;
    vec3 squares;  // xx, yy, zz
    vec3 products; // xy, yz, xz
};

ShgridMoments ShgridNoMoments()
{
    ShgridMoments m;
    m.solidAngle = 0.0;
    m.first = vec3(0.0);
    m.squares = vec3(0.0);
    m.products = vec3(0.0);
    return m;
}

vec3 ShgridToVertex(sampler2D table, int vertex, vec3 position)
{
    vec4 at = ShgridRecord(table, vertex);
    vec3 to = vec3(at.x, at.y, at.z) - position;
    return to / max(length(to), 1e-20);
}

// Moments of a polygon in closed form, as shgrid_add_polygon_ has them. order: 1 in front of it, -1 behind it.
ShgridMoments ShgridPolygonMoments(sampler2D table, int vertex, int count, vec3 normal, float order, vec3 position)
{
    ShgridMoments m = ShgridNoMoments();
    vec3 away = normal * -order;
    vec3 a = ShgridToVertex(table, vertex + count - 1, position);
    float re = 1.0;
    float im = 0.0;
    for (int i = 0; i < count; i++) {
        vec3 b = ShgridToVertex(table, vertex + i, position);
        vec3 normalOfEdge = cross(a, b);
        float cosine = dot(a, b);
        float sine = max(length(normalOfEdge), 1e-7);
        m.first += normalOfEdge * (sine > 1e-3 ? 0.5 * atan(sine, cosine) / sine : 0.5);
        vec3 inward = normalOfEdge * (cosine > 0.0 ? 1.0 / (1.0 + cosine) : 1.0 / sine);
        vec3 arc = cosine > 0.0 ? a + b : cross(inward, a - b);
        m.squares += arc * inward * 2.0;
        m.products += vec3(arc.x * inward.y + arc.y * inward.x, arc.y * inward.z + arc.z * inward.y,
                           arc.x * inward.z + arc.z * inward.x);
        // The product of complex numbers whose arguments are half the solid angles of triangles. A quarter of each
        // keeps it within the range of floats.
        float x = 0.25 * (1.0 + dot(away, a) + dot(away, b) + cosine);
        float y = 0.25 * order * dot(away, normalOfEdge);
        float t = re * x - im * y;
        im = re * y + im * x;
        re = t;
        a = b;
    }
    m.solidAngle = 2.0 * atan(im, re);
    if (m.solidAngle < 0.0)
        m.solidAngle += 12.566370614;
    if (!(m.solidAngle > 0.0 && m.solidAngle < 6.2832))
        return ShgridNoMoments();
    m.first *= order;
    m.squares = m.squares * (order / 6.0) + vec3(m.solidAngle / 3.0);
    m.products *= order / 6.0;
    return m;
}

// Moments of the polygons of a light, as points where they are far: shgrid_polygon_moments_.
ShgridMoments ShgridLightMoments(sampler2D table, int polygon, int count, bool twoSided, vec3 position)
{
    ShgridMoments sum = ShgridNoMoments();
    for (int i = 0; i < count; i++) {
        vec4 plane = ShgridRecord(table, polygon + 3 * i);
        vec4 ball = ShgridRecord(table, polygon + 3 * i + 1);
        vec4 size = ShgridRecord(table, polygon + 3 * i + 2);
        vec3 normal = vec3(plane.x, plane.y, plane.z);
        vec3 to = vec3(ball.x, ball.y, ball.z) - position;
        float height = -dot(normal, to);
        if (height <= 0.0 && !twoSided)
            continue;
        float range = max(length(to), 1e-20);
        float exact = ball.w > 0.0 ? clamp((8.0 * ball.w - range) / (2.0 * ball.w), 0.0, 1.0) : 0.0;
        if (exact > 0.0) {
            float order = height < 0.0 ? -1.0 : 1.0;
            ShgridMoments m = ShgridPolygonMoments(table, int(size.y), int(size.z), normal, order, position);
            sum.solidAngle += exact * m.solidAngle;
            sum.first += m.first * exact;
            sum.squares += m.squares * exact;
            sum.products += m.products * exact;
        }
        if (exact < 1.0) {
            vec3 d = to / range;
            float w = (1.0 - exact) * size.x * abs(dot(normal, d)) / (range * range);
            sum.solidAngle += w;
            sum.first += d * w;
            sum.squares += d * d * w;
            sum.products += vec3(d.x * d.y, d.y * d.z, d.x * d.z) * w;
        }
    }
    return sum;
}

// The share of a light that acts as a direction; the rest, which is near, acts as coefficients. The rule of
// shgrid_polygon_beam_.
float ShgridDirected(ShgridMoments m)
{
    float strength = length(m.first);
    if (strength >= (1.0 - 0.4314 / 8.0) * m.solidAngle)
        return 1.0;
    // Of the largest variance at right angles to the mean direction: shgrid_variance_.
    vec3 d = m.first / strength;
    vec3 row = m.squares * d;
    row += vec3(m.products.x * d.y + m.products.z * d.z, m.products.x * d.x + m.products.y * d.z,
                m.products.z * d.x + m.products.y * d.y);
    float along = dot(row, d);
    float trace = m.squares.x + m.squares.y + m.squares.z - along;
    float squares = dot(m.squares, m.squares) + 2.0 * dot(m.products, m.products) - 2.0 * dot(row, row) + along * along;
    float variance = 0.5 * (trace + sqrt(max(2.0 * squares - trace * trace, 0.0))) / m.solidAngle;
    float directed = clamp((0.6294 - 4.0 * variance) / (0.6294 - 0.4314), 0.0, 1.0);
    return directed * directed * (3.0 - 2.0 * directed);
}

// Light of polygons of radiosity 1 on a surface with that normal.
float ShgridPolygons(ShgridMoments m, vec3 n)
{
    float strength = length(m.first);
    if (!(strength > 0.0 && m.solidAngle > 0.0))
        return 0.0;
    float directed = ShgridDirected(m);
    float spread = 2.0 * strength / m.solidAngle - 1.0;
    spread = sqrt(max(1.0 - spread * spread, 0.0));
    vec3 lobe = ShgridDirect(m.first / strength, spread, vec3(1.0), n);
    // The sum over the basis: bands 0, 1 and 2 of the cosine and of what is in direction w are 1, 2 n . w and
    // 5 / 8 (3 (n . w)^2 - 1) over 4 pi.
    float second = dot(m.squares, n * n) + 2.0 * dot(m.products, vec3(n.x * n.y, n.y * n.z, n.x * n.z));
    float wide = m.solidAngle + 2.0 * dot(m.first, n) + 0.625 * (3.0 * second - m.solidAngle);
    return directed * lobe.x * strength / 3.14159265 + (1.0 - directed) * wide / 12.566370614;
}

// Falloff of a point light or spotlight with distance: shgrid_falloff_. a, b: texels 4 and 5 of the light.
float ShgridFalloff(int curve, float intensity, float nearest, vec4 a, vec4 b, float range)
{
    float d = max(sqrt(range * range + a.x * a.x), nearest);
    if (curve == 1)
        return intensity / 8000.0 - d * a.y;
    if (curve == 2) {
        float r = d * d / (a.z * a.z);
        float window = max(1.0 - r * r, 0.0);
        return intensity / (d * d) * (window * window);
    }
    if (curve == 3) {
        float e = min(d, b.x);
        float x = clamp((a.z - d) / (a.z - a.w), 0.0, 1.0);
        return intensity / (b.y + e * (b.z + e * b.w)) * (x * x * x * (x * (6.0 * x - 15.0) + 10.0));
    }
    return intensity / (d * d);
}

// The fraction of a spotlight that its cone lets through: shgrid_cone_. axis: direction of the beam; cone: texel 6 of
// the light; to: from the position to the light.
float ShgridCone(bool byAngles, vec3 axis, vec4 cone, float fade, vec3 to, float range)
{
    float along = -dot(to, axis);
    if (along < 0.0)
        return 0.0;
    if (byAngles) {
        float cosine = range > 0.0 ? along / range : 0.0;
        if (cosine <= cone.y)
            return 0.0;
        return cosine * (cosine < cone.x ? pow((cosine - cone.y) / (cone.x - cone.y), cone.z) : 1.0);
    }
    float edge = cone.w * along - length(to + axis * along);
    return edge <= 0.0 ? 0.0 : edge < fade ? edge / fade : 1.0;
}

// Light of a point light, a spotlight or a sun on a surface with that normal, for color 1. at: its first texel.
float ShgridSource(sampler2D table, int at, vec4 kind, float intensity, vec3 position, vec3 n)
{
    vec4 aim = ShgridRecord(table, at + 3);
    vec3 axis = vec3(aim.x, aim.y, aim.z);
    vec3 lobe;
    if (int(kind.x) == 2) {
        lobe = ShgridDirect(axis, aim.w, vec3(1.0), n);
        return intensity * lobe.x;
    }
    vec4 origin = ShgridRecord(table, at + 2);
    vec4 b = ShgridRecord(table, at + 5);
    vec3 to = vec3(origin.x, origin.y, origin.z) - position;
    float range = length(to);
    float strength = ShgridFalloff(int(kind.y), intensity, origin.w, ShgridRecord(table, at + 4), b, range);
    if (int(kind.x) == 1) {
        vec4 last = ShgridRecord(table, at + 7);
        strength *= ShgridCone(int(kind.w) >= 2, axis, ShgridRecord(table, at + 6), last.x, to, range);
    }
    if (!(strength > 0.0 && strength < 1e30))
        return 0.0;
    lobe = ShgridDirect(to / max(range, 1e-20), 0.0, vec3(1.0), n);
    return strength * lobe.x;
}

// Light of light number `number` on a surface with that normal, without shadows, with its style.
vec3 ShgridNamedLight(sampler2D table, int number, vec3 position, vec3 n)
{
    int at = 16 + 8 * number;
    vec4 kind = ShgridRecord(table, at);
    vec4 color = ShgridRecord(table, at + 1);
    int style = int(kind.z);
    vec4 styles = ShgridRecord(table, style / 4);
    float light;
    if (int(kind.x) == 3) {
        vec4 from = ShgridRecord(table, at + 7);
        bool twoSided = int(kind.w) % 2 == 1;
        light = color.w * ShgridPolygons(ShgridLightMoments(table, int(from.y), int(from.z), twoSided, position), n);
    } else {
        light = ShgridSource(table, at, kind, color.w, position, n);
    }
    return vec3(color.x, color.y, color.z) * (light * styles[style % 4]);
}

// Light of the lights in the list of a brick on a surface with that normal, times the weight of the place. p: texture
// coordinates of ShgridPlace.
vec3 ShgridBrickLights(usampler3D names, sampler3D shares, sampler2D table, ShgridAtlas atlas, vec3 p, vec3 position,
                       vec3 n)
{
    vec3 light = vec3(0.0);
    for (int group = 0; group < 4; group++) {
        ivec3 brick = ivec3(vec3(p.x, p.y, p.z + float(group)) * atlas.bricks);
        uvec4 lights = texelFetch(names, brick, 0);
        if (lights[0] == 65535u)
            break;
        vec4 share = textureLod(shares, vec3(p.x, p.y, 0.25 * (p.z + float(group))), 0.0);
        for (int i = 0; i < 4; i++)
            if (lights[i] != 65535u && share[i] > 0.0)
                light += ShgridNamedLight(table, int(lights[i]), position, n) * share[i];
    }
    return light;
}

// Light at a world position, of the textures of shgrid_atlas_fill_lights.
vec3 ShgridHalfLights(usampler3D indirection, sampler3D s0, sampler3D s1, sampler3D s2, sampler3D s3, sampler3D s4,
                      sampler3D s5, sampler3D s6, usampler3D names, sampler3D shares, sampler2D table,
                      ShgridAtlas atlas, vec3 position, vec3 normal)
{
    vec4 at = ShgridPlace(indirection, atlas, position);
    vec3 p = vec3(at.x, at.y, at.z);
    vec4 last = textureLod(s6, p, 0.0);
    vec3 light = ShgridSumTexels(textureLod(s0, p, 0.0), textureLod(s1, p, 0.0), textureLod(s2, p, 0.0),
                                 textureLod(s3, p, 0.0), textureLod(s4, p, 0.0), textureLod(s5, p, 0.0), last, normal);
    light += ShgridBrickLights(names, shares, table, atlas, p, position, normal);
    return max(light, vec3(0.0)) * (at.w / max(last.w, 1e-3));
}
