// SPDX-License-Identifier: MIT. Sampling of a sparse SH grid in the textures of shgrid_atlas.h: HLSL, shader model 4
// and later. Include shgrid.hlsl first. Light is linear, 1.0 is lightmap byte 255. Textures of the atlas are filtered
// linearly, without mipmaps.

struct ShgridAtlas {
    float3 mins;   // of shgrid_grid: world position of the lowest point
    float3 cell;   // of shgrid_grid
    float3 bounds; // of shgrid_grid, as floats
    float3 bricks; // of shgrid_atlas, as floats
    float entry; // 2^shift of shgrid_atlas
    float limit1; // of shgrid_atlas
    float limit2;
};

// xyz: texture coordinates in the atlas of a world position. w: 1, or 0 where the grid has no light.
float4 ShgridPlace(Texture3D<uint4> indirection, ShgridAtlas atlas, float3 position)
{
    float3 at = min(max((position - atlas.mins) / atlas.cell, float3(0.0, 0.0, 0.0)), atlas.bounds * 0.999999);
    int3 entry = int3(at / atlas.entry);
    uint4 brick = indirection.Load(int4(entry, 0));
    float3 texel = frac(at / exp2(float(brick.w))) * 4.0 + float3(0.5, 0.5, 0.5);
    float3 place = (float3(float(brick.x), float(brick.y), float(brick.z)) * 5.0 + texel) / (atlas.bricks * 5.0);
    return float4(place.x, place.y, place.z, brick.w > 0u ? 1.0 : 0.0);
}

// Light on a surface with that unit normal, from the seven texels of SHGRID_ATLAS_SNORM. Those of SHGRID_ATLAS_HALF are
// in the order of ShgridLightTexels.
float3 ShgridLightSnorm(ShgridAtlas atlas, float3 mean, float4 t1, float4 t2, float4 t3, float4 t4,
                        float4 t5, float4 t6, float3 n)
{
    float3 band1 = float3(t1.x, t1.y, t1.z) * (0.488602512 * n.y) + float3(t1.w, t2.x, t2.y) * (0.488602512 * n.z);
    band1 += float3(t2.z, t2.w, t3.x) * (0.488602512 * n.x);
    float3 band2 = float3(t3.y, t3.z, t3.w) * (1.092548431 * n.x * n.y);
    band2 += float3(t4.x, t4.y, t4.z) * (1.092548431 * n.y * n.z);
    band2 += float3(t4.w, t5.x, t5.y) * (0.315391565 * (3.0 * n.z * n.z - 1.0));
    band2 += float3(t5.z, t5.w, t6.x) * (1.092548431 * n.x * n.z);
    band2 += float3(t6.y, t6.z, t6.w) * (0.546274215 * (n.x * n.x - n.y * n.y));
    float3 share = float3(0.282094792, 0.282094792, 0.282094792) + band1 * atlas.limit1 + band2 * atlas.limit2;
    return max(mean * share, float3(0.0, 0.0, 0.0));
}

// Light at a world position, SHGRID_ATLAS_HALF.
float3 ShgridHalf(Texture3D<uint4> indirection, Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2,
                  Texture3D<float4> s3, Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6,
                  SamplerState filter, ShgridAtlas atlas, float3 position, float3 normal)
{
    float4 at = ShgridPlace(indirection, atlas, position);
    float3 p = float3(at.x, at.y, at.z);
    return ShgridLightTexels(s0.SampleLevel(filter, p, 0.0), s1.SampleLevel(filter, p, 0.0),
                             s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                             s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0),
                             s6.SampleLevel(filter, p, 0.0), normal) * at.w;
}

// Light at a world position, SHGRID_ATLAS_SNORM.
float3 ShgridSnorm(Texture3D<uint4> indirection, Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2,
                  Texture3D<float4> s3, Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6,
                  SamplerState filter, ShgridAtlas atlas, float3 position, float3 normal)
{
    float4 at = ShgridPlace(indirection, atlas, position);
    float3 p = float3(at.x, at.y, at.z);
    float4 mean = s0.SampleLevel(filter, p, 0.0);
    return ShgridLightSnorm(atlas, float3(mean.x, mean.y, mean.z), s1.SampleLevel(filter, p, 0.0),
                            s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                            s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0),
                            s6.SampleLevel(filter, p, 0.0), normal) * at.w;
}

// ---- lights that the grid names, in the textures of shgrid_atlas_fill_lights ----
// Shares are filtered linearly. Names and the table of lights are read without a filter; shgrid_put_light_ and
// shgrid_put_polygon_ say what is in the texels of the table.

// A texel of the table of lights.
float4 ShgridRecord(Texture2D<float4> table, int number)
{
    return table.Load(int3(number % 1024, number / 1024, 0));
}

// Integrals over the solid angle that a light covers: of 1, of w, and of w w^T, w the unit direction.
struct ShgridMoments {
    float solidAngle;
    float3 first;
    float3 squares;  // xx, yy, zz
    float3 products; // xy, yz, xz
};

ShgridMoments ShgridNoMoments()
{
    ShgridMoments m;
    m.solidAngle = 0.0;
    m.first = float3(0.0, 0.0, 0.0);
    m.squares = float3(0.0, 0.0, 0.0);
    m.products = float3(0.0, 0.0, 0.0);
    return m;
}

float3 ShgridToVertex(Texture2D<float4> table, int vertex, float3 position)
{
    float4 at = ShgridRecord(table, vertex);
    float3 to = float3(at.x, at.y, at.z) - position;
    return to / max(length(to), 1e-20);
}

// Moments of a polygon in closed form, as shgrid_add_polygon_ has them. order: 1 in front of it, -1 behind it.
ShgridMoments ShgridPolygonMoments(Texture2D<float4> table, int vertex, int count, float3 normal, float order,
                                   float3 position)
{
    ShgridMoments m = ShgridNoMoments();
    float3 away = normal * -order;
    float3 a = ShgridToVertex(table, vertex + count - 1, position);
    float re = 1.0;
    float im = 0.0;
    for (int i = 0; i < count; i++) {
        float3 b = ShgridToVertex(table, vertex + i, position);
        float3 normalOfEdge = cross(a, b);
        float cosine = dot(a, b);
        float sine = max(length(normalOfEdge), 1e-7);
        m.first += normalOfEdge * (sine > 1e-3 ? 0.5 * atan2(sine, cosine) / sine : 0.5);
        float3 inward = normalOfEdge * (cosine > 0.0 ? 1.0 / (1.0 + cosine) : 1.0 / sine);
        float3 arc = cosine > 0.0 ? a + b : cross(inward, a - b);
        m.squares += arc * inward * 2.0;
        m.products += float3(arc.x * inward.y + arc.y * inward.x, arc.y * inward.z + arc.z * inward.y,
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
    m.solidAngle = 2.0 * atan2(im, re);
    if (m.solidAngle < 0.0)
        m.solidAngle += 12.566370614;
    if (!(m.solidAngle > 0.0 && m.solidAngle < 6.2832))
        return ShgridNoMoments();
    m.first *= order;
    m.squares = m.squares * (order / 6.0) + float3(m.solidAngle / 3.0, m.solidAngle / 3.0, m.solidAngle / 3.0);
    m.products *= order / 6.0;
    return m;
}

// Moments of the polygons of a light, as points where they are far: shgrid_polygon_moments_.
ShgridMoments ShgridLightMoments(Texture2D<float4> table, int polygon, int count, bool twoSided, float3 position)
{
    ShgridMoments sum = ShgridNoMoments();
    for (int i = 0; i < count; i++) {
        float4 plane = ShgridRecord(table, polygon + 3 * i);
        float4 ball = ShgridRecord(table, polygon + 3 * i + 1);
        float4 size = ShgridRecord(table, polygon + 3 * i + 2);
        float3 normal = float3(plane.x, plane.y, plane.z);
        float3 to = float3(ball.x, ball.y, ball.z) - position;
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
            float3 d = to / range;
            float w = (1.0 - exact) * size.x * abs(dot(normal, d)) / (range * range);
            sum.solidAngle += w;
            sum.first += d * w;
            sum.squares += d * d * w;
            sum.products += float3(d.x * d.y, d.y * d.z, d.x * d.z) * w;
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
    float3 d = m.first / strength;
    float3 row = m.squares * d;
    row += float3(m.products.x * d.y + m.products.z * d.z, m.products.x * d.x + m.products.y * d.z,
                  m.products.z * d.x + m.products.y * d.y);
    float along = dot(row, d);
    float trace = m.squares.x + m.squares.y + m.squares.z - along;
    float squares = dot(m.squares, m.squares) + 2.0 * dot(m.products, m.products) - 2.0 * dot(row, row) + along * along;
    float variance = 0.5 * (trace + sqrt(max(2.0 * squares - trace * trace, 0.0))) / m.solidAngle;
    float directed = clamp((0.6294 - 4.0 * variance) / (0.6294 - 0.4314), 0.0, 1.0);
    return directed * directed * (3.0 - 2.0 * directed);
}

// Light of polygons of radiosity 1 on a surface with that normal.
float ShgridPolygons(ShgridMoments m, float3 n)
{
    float strength = length(m.first);
    if (!(strength > 0.0 && m.solidAngle > 0.0))
        return 0.0;
    float directed = ShgridDirected(m);
    float spread = 2.0 * strength / m.solidAngle - 1.0;
    spread = sqrt(max(1.0 - spread * spread, 0.0));
    float3 lobe = ShgridDirect(m.first / strength, spread, float3(1.0, 1.0, 1.0), n);
    // The sum over the basis: bands 0, 1 and 2 of the cosine and of what is in direction w are 1, 2 n . w and
    // 5 / 8 (3 (n . w)^2 - 1) over 4 pi.
    float second = dot(m.squares, n * n) + 2.0 * dot(m.products, float3(n.x * n.y, n.y * n.z, n.x * n.z));
    float wide = m.solidAngle + 2.0 * dot(m.first, n) + 0.625 * (3.0 * second - m.solidAngle);
    return directed * lobe.x * strength / 3.14159265 + (1.0 - directed) * wide / 12.566370614;
}

// Falloff of a point light or spotlight with distance: shgrid_falloff_. a, b: texels 4 and 5 of the light.
float ShgridFalloff(int curve, float intensity, float nearest, float4 a, float4 b, float range)
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
float ShgridCone(bool byAngles, float3 axis, float4 cone, float fade, float3 to, float range)
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
float ShgridSource(Texture2D<float4> table, int at, float4 kind, float intensity, float3 position, float3 n)
{
    float4 aim = ShgridRecord(table, at + 3);
    float3 axis = float3(aim.x, aim.y, aim.z);
    float3 lobe;
    if (int(kind.x) == 2) {
        lobe = ShgridDirect(axis, aim.w, float3(1.0, 1.0, 1.0), n);
        return intensity * lobe.x;
    }
    float4 origin = ShgridRecord(table, at + 2);
    float4 b = ShgridRecord(table, at + 5);
    float3 to = float3(origin.x, origin.y, origin.z) - position;
    float range = length(to);
    float strength = ShgridFalloff(int(kind.y), intensity, origin.w, ShgridRecord(table, at + 4), b, range);
    if (int(kind.x) == 1) {
        float4 last = ShgridRecord(table, at + 7);
        strength *= ShgridCone(int(kind.w) >= 2, axis, ShgridRecord(table, at + 6), last.x, to, range);
    }
    if (!(strength > 0.0 && strength < 1e30))
        return 0.0;
    lobe = ShgridDirect(to / max(range, 1e-20), 0.0, float3(1.0, 1.0, 1.0), n);
    return strength * lobe.x;
}

// Light of light number `number` on a surface with that normal, without shadows, with its style.
float3 ShgridNamedLight(Texture2D<float4> table, int number, float3 position, float3 n)
{
    int at = 16 + 8 * number;
    float4 kind = ShgridRecord(table, at);
    float4 color = ShgridRecord(table, at + 1);
    int style = int(kind.z);
    float4 styles = ShgridRecord(table, style / 4);
    float light;
    if (int(kind.x) == 3) {
        float4 from = ShgridRecord(table, at + 7);
        bool twoSided = int(kind.w) % 2 == 1;
        light = color.w * ShgridPolygons(ShgridLightMoments(table, int(from.y), int(from.z), twoSided, position), n);
    } else {
        light = ShgridSource(table, at, kind, color.w, position, n);
    }
    return float3(color.x, color.y, color.z) * (light * styles[style % 4]);
}

// Light of the lights in the list of a brick on a surface with that normal, times the weight of the place. p: texture
// coordinates of ShgridPlace.
float3 ShgridBrickLights(Texture3D<uint4> names, Texture3D<float4> shares, Texture2D<float4> table,
                         SamplerState filter, ShgridAtlas atlas, float3 p, float3 position, float3 n)
{
    float3 light = float3(0.0, 0.0, 0.0);
    for (int group = 0; group < 4; group++) {
        int3 brick = int3(float3(p.x, p.y, p.z + float(group)) * atlas.bricks);
        uint4 lights = names.Load(int4(brick, 0));
        if (lights[0] == 65535u)
            break;
        float4 share = shares.SampleLevel(filter, float3(p.x, p.y, 0.25 * (p.z + float(group))), 0.0);
        for (int i = 0; i < 4; i++)
            if (lights[i] != 65535u && share[i] > 0.0)
                light += ShgridNamedLight(table, int(lights[i]), position, n) * share[i];
    }
    return light;
}

// Light at a world position, of the textures of shgrid_atlas_fill_lights.
float3 ShgridHalfLights(Texture3D<uint4> indirection, Texture3D<float4> s0, Texture3D<float4> s1, Texture3D<float4> s2,
                        Texture3D<float4> s3, Texture3D<float4> s4, Texture3D<float4> s5, Texture3D<float4> s6,
                        Texture3D<uint4> names, Texture3D<float4> shares, Texture2D<float4> table,
                        SamplerState filter, ShgridAtlas atlas, float3 position, float3 normal)
{
    float4 at = ShgridPlace(indirection, atlas, position);
    float3 p = float3(at.x, at.y, at.z);
    float4 last = s6.SampleLevel(filter, p, 0.0);
    float3 light = ShgridSumTexels(s0.SampleLevel(filter, p, 0.0), s1.SampleLevel(filter, p, 0.0),
                                   s2.SampleLevel(filter, p, 0.0), s3.SampleLevel(filter, p, 0.0),
                                   s4.SampleLevel(filter, p, 0.0), s5.SampleLevel(filter, p, 0.0), last, normal);
    light += ShgridBrickLights(names, shares, table, filter, atlas, p, position, normal);
    return max(light, float3(0.0, 0.0, 0.0)) * (at.w / max(last.w, 1e-3));
}
