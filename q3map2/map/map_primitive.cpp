// GPL-2.0-or-later. Brushes and patches of map text, moved relative to the origin of their entity.
#include "q3map2/map/map_primitive.h"

#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/map/map_texture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace q3 {

// ---- Brushes and patches of map text ----

namespace {

constexpr std::size_t kMaxSides = 1024; ///< of a brush; limit of this program, chosen
constexpr int kMaxPatchSize = 31;       ///< control points a side: the greatest odd number below the 32 of engines
constexpr std::string_view kTextures = "textures/";
/// CONTENTS_DETAIL, the only bit that still has a meaning in the contents word of a side.
constexpr int kDetailContents = 0x8000000;
/// Patches whose control points are all within this distance of one line are ignored. Game units.
constexpr float kOnOneLine = 0.01f;

/// Nearest float; 0 if the value is out of range.
float StoredFloat(double value) {
    return std::abs(value) <= double(std::numeric_limits<float>::max()) ? float(value) : 0;
}

bool IsDegenerate(const Patch &patch) {
    const Vec3f first = patch.verts.front().xyz;
    Vec3f farthest = first;
    for (const DrawVert &v : patch.verts)
        if (Length(v.xyz - first) > Length(farthest - first))
            farthest = v.xyz;
    const Vec3d direction = Normalize(Vec3d(farthest) - Vec3d(first));
    for (const DrawVert &v : patch.verts)
        if (Length(Cross(Vec3d(v.xyz) - Vec3d(first), direction)) > double(kOnOneLine))
            return false;
    return true;
}

} // namespace

std::array<double, 3> PrimitiveReader::ReadVector() {
    scanner_.Expect("(");
    std::array<double, 3> vector{};
    for (double &value : vector)
        value = scanner_.Number();
    scanner_.Expect(")");
    return vector;
}

void PrimitiveReader::ReadPoints(BrushSide &side, SideText &text) {
    std::array<Vec3d, 3> &points = text.points;
    text.hasPoints = true;
    for (Vec3d &p : points) {
        const std::array<double, 3> v = ReadVector();
        p = {v[0], v[1], v[2]};
    }
    const Vec3d cross = Cross(points[2] - points[0], points[1] - points[0]);
    const double length = Length(cross);
    if (!(length > 0) || !std::isfinite(length))
        return;
    const Vec3d normal = cross / length;
    side.plane = {normal, Dot(normal, points[0])};
    side.hasPlane = true;
    side.planeNum = planes_.Find(side.plane.normal, side.plane.dist, points);
}

/// Plane of brushDef3: four numbers n, d with n . p + d = 0.
void PrimitiveReader::ReadPlaneNumbers(BrushSide &side) {
    scanner_.Expect("(");
    std::array<double, 4> numbers{};
    for (double &value : numbers)
        value = scanner_.Number();
    scanner_.Expect(")");
    const Vec3d normal{numbers[0], numbers[1], numbers[2]};
    const double length = Length(normal);
    if (!(length > 0) || !std::isfinite(length))
        return;
    side.plane = {normal / length, -numbers[3] / length};
    side.hasPlane = true;
    side.planeNum = planes_.Find(side.plane.normal, side.plane.dist);
}

/// The name with "textures/" in front.
std::string PrimitiveReader::ShaderName(const std::string &token, NameForm form) const {
    const bool isWhole = form == NameForm::WholeOrShort && StartsWithNoCase(token, kTextures);
    std::string name = isWhole ? token : std::string(kTextures) + token;
    if (name.size() > kMaxShaderName)
        scanner_.Fail(fmt::format("the shader name '{}...' has {} characters, expected at most {}",
                                  PrintableForMessage(name), name.size(), kMaxShaderName));
    return name;
}

const ShaderInfo &PrimitiveReader::Shader(const std::string &name) {
    const ShaderInfo *&shader = shaders_[name];
    if (!shader)
        shader = &context_.shaders.Get(name);
    return *shader;
}

/// Reads the texture axes that follow the shader name in classic and Valve 220 sides.
TextureProjection PrimitiveReader::ReadAxes(const BrushSide &side) {
    TextureAxes texture;
    const std::string first = scanner_.NeedOnLine("a number or '['");
    texture.hasAxes = first == "[";
    if (!texture.hasAxes)
        texture.shift = {scanner_.NumberOf(first), scanner_.Number()};
    for (std::size_t row = 0; texture.hasAxes && row < 2; ++row) {
        if (row > 0)
            scanner_.Expect("[");
        const double x = scanner_.Number(), y = scanner_.Number(), z = scanner_.Number();
        texture.axes[row] = {x, y, z};
        texture.shift[row] = scanner_.Number();
        scanner_.Expect("]");
    }
    texture.rotate = scanner_.Number();
    texture.scale[0] = scanner_.Number();
    texture.scale[1] = scanner_.Number();
    const GeometryDirectives &shader = side.shader->geometry;
    if (texture.hasAxes)
        return ProjectValve(texture, shader);
    return side.planeNum < 0 ? TextureProjection{} : ProjectClassic(texture, planes_[side.planeNum].normal, shader);
}

/// Reads the flags at the end of the line: three whole numbers or nothing.
void PrimitiveReader::ReadFlags(BrushSide &side, SideText &text) {
    std::string token;
    if (!scanner_.NextOnLine(token))
        return;
    if (token == "}" || token == "(" || token == "{")
        return scanner_.PushBack();
    text.flags[0] = IntegerFromText(token);
    if (text.flags[0] & kDetailContents)
        side.compileFlags |= C_DETAIL;
    text.flags[1] = scanner_.Integer();
    text.flags[2] = scanner_.Integer();
}

/// Replaces a projection that maps the side to a line or a point of the texture, with a warning if the side is drawn.
void PrimitiveReader::ReplaceUnusableProjection(BrushSide &side, const std::string &shader) const {
    if (side.planeNum < 0 || HasExtent(side.texture, planes_[side.planeNum].normal))
        return;
    const GeometryDirectives &directives = side.shader->geometry;
    side.texture = DefaultProjection(planes_[side.planeNum].normal, directives);
    if ((side.compileFlags & C_NODRAW) == 0 && !directives.hasTexGen && !context_.options.flat)
        scanner_.Warn("texture without extent",
                      fmt::format("the texture {} has no extent on this side: its axes are parallel to each other or "
                                  "along the side's normal, or of length zero; it gets default axes; set them again "
                                  "in the editor",
                                  PrintableForMessage(shader)));
}

BrushSide PrimitiveReader::ReadSide(Form form, SideText &text) {
    BrushSide side;
    TextureMatrix matrix{};
    if (form == Form::Plane)
        ReadPlaneNumbers(side);
    else
        ReadPoints(side, text);
    if (form != Form::Axes) {
        scanner_.Expect("(");
        for (auto &row : matrix)
            row = ReadVector();
        scanner_.Expect(")");
    }
    text.shader = scanner_.NeedOnLine("the name of a shader");
    side.shader = &Shader(ShaderName(text.shader, form == Form::Plane ? NameForm::WholeOrShort : NameForm::Short));
    side.surfaceFlags = side.shader->surfaceFlags;
    side.contentFlags = side.shader->contentFlags;
    side.compileFlags = side.shader->compileFlags;
    if (form == Form::Axes)
        side.texture = ReadAxes(side);
    else if (side.planeNum >= 0)
        side.texture = ProjectMatrix(matrix, planes_[side.planeNum].normal);
    ReplaceUnusableProjection(side, text.shader);
    text.texture = side.texture;
    side.texture = FinalProjection(side.texture, side.shader->geometry, context_.options.flat);
    ReadFlags(side, text);
    return side;
}

Brush PrimitiveReader::ReadBrush(const std::string &first, std::vector<SideText> *texts) {
    const Form form = EqualNoCase(first, "brushDef")    ? Form::Matrix
                      : EqualNoCase(first, "brushDef3") ? Form::Plane
                                                        : Form::Axes;
    Brush brush;
    if (form == Form::Axes)
        scanner_.PushBack();
    else
        scanner_.Expect("{");
    for (;;) {
        const std::string token = scanner_.Need("a side or '}'");
        if (token == "}")
            break;
        if (token != "(") {
            if (form == Form::Axes || !brush.sides.empty() || token == "{")
                scanner_.Fail(fmt::format("expected '(' of a side or '}}', found '{}'", PrintableForMessage(token)));
            continue; // keys of the brush
        }
        scanner_.PushBack();
        if (brush.sides.size() == kMaxSides)
            scanner_.Fail(fmt::format("the brush has too many sides, expected at most {}", kMaxSides));
        SideText text;
        brush.sides.push_back(ReadSide(form, text));
        if (texts)
            texts->push_back(std::move(text));
    }
    if (form != Form::Axes)
        scanner_.Expect("}");
    return brush;
}

void PrimitiveReader::ReadControlPoints(Patch &patch) {
    const std::size_t width = std::size_t(patch.width), height = std::size_t(patch.height);
    patch.verts.resize(width * height);
    scanner_.Expect("(");
    for (std::size_t column = 0; column < width; ++column) {
        scanner_.Expect("(");
        for (std::size_t row = 0; row < height; ++row) {
            scanner_.Expect("(");
            std::array<float, 5> numbers{};
            for (float &value : numbers)
                value = StoredFloat(scanner_.Number());
            scanner_.Expect(")");
            DrawVert &v = patch.verts[row * width + column];
            v.xyz = {numbers[0], numbers[1], numbers[2]};
            v.st = {numbers[3], numbers[4]};
        }
        scanner_.Expect(")");
    }
    scanner_.Expect(")");
}

std::optional<Patch> PrimitiveReader::ReadPatch(PatchText *text) {
    scanner_.Expect("{");
    Patch patch;
    PatchText read{scanner_.Need("the name of a shader"), {}};
    patch.shader = &Shader(ShaderName(read.shader, NameForm::WholeOrShort));
    scanner_.Expect("(");
    patch.width = scanner_.Integer();
    patch.height = scanner_.Integer();
    if (patch.width < 0 || patch.width > kMaxPatchSize || patch.height < 0 || patch.height > kMaxPatchSize)
        scanner_.Fail(fmt::format("a patch of {} x {} points, expected at most {} x {}", patch.width, patch.height,
                                  kMaxPatchSize, kMaxPatchSize));
    for (std::string token; (token = scanner_.Need("')'")) != ")";)
        read.header.push_back(std::move(token));
    if (text)
        *text = std::move(read);
    ReadControlPoints(patch);
    while (scanner_.Need("'}'") != "}") { // keys of the patch
    }
    scanner_.Expect("}");
    if (patch.width < 3 || patch.height < 3 || patch.width % 2 == 0 || patch.height % 2 == 0)
        scanner_.Warn("patch size", fmt::format("a patch of {} x {} points is left out, expected odd numbers from 3",
                                                patch.width, patch.height));
    else if (!std::ranges::all_of(patch.verts, [](const DrawVert &v) { return InWorld(v.xyz); }))
        scanner_.Warn("patch outside", "a patch that leaves the world is left out");
    else if (IsDegenerate(patch))
        scanner_.Warn("degenerate patch", "a patch whose points are in one line is left out");
    else
        return patch;
    return std::nullopt;
}

// ---- Brushes and patches moved relative to the origin of their entity ----

namespace {

void MoveBounds(Boundsf &bounds, const Vec3f &by) {
    bounds.mins += by, bounds.maxs += by;
}

void MoveBrush(Brush &brush, const Vec3f &by, PlaneTable &planes) {
    for (BrushSide &side : brush.sides) {
        side.plane.dist += Dot(side.plane.normal, Vec3d(by));
        const Plane plane = planes[side.planeNum];
        side.planeNum = planes.Find(plane.normal, plane.dist + Dot(plane.normal, Vec3d(by)));
        for (Vec3f &p : side.winding)
            p += by;
    }
    MoveBounds(brush.bounds, by);
}

bool InWorld(const Brush &brush) {
    return InWorld(brush.bounds.mins) && InWorld(brush.bounds.maxs);
}

bool InWorld(const Patch &patch) {
    return std::ranges::all_of(patch.verts, [](const DrawVert &v) { return InWorld(v.xyz); });
}

/// Undoes the translation by the origin brush and applies the key origin.
void MoveBack(MapEntity &group, PlaneTable &planes, const BspContext &context) {
    if (group.origin == Vec3f{})
        return;
    const bool isFar = !InWorld(group.origin);
    if (isFar || group.brushOrigin == Vec3f{})
        context.WarnAt("group with an origin", group.number, 0,
                       isFar ? "the origin of a func_group is outside the world: it has no effect"
                             : "a func_group has the key origin but no origin brush: it is moved by the key");
    MoveEntity(group, isFar ? group.brushOrigin : group.origin, planes);
    const auto leaves = [&](const auto &primitive) {
        if (!InWorld(primitive))
            context.WarnAt("moved out of the world", group.number, primitive.primitive,
                           "the origin of its func_group moves it out of the world: it is left out");
        return !InWorld(primitive);
    };
    std::erase_if(group.brushes, leaves);
    std::erase_if(group.colorVolumes, leaves);
    std::erase_if(group.patches, leaves);
}

} // namespace

void MoveEntity(MapEntity &entity, const Vec3f &by, PlaneTable &planes) {
    for (Brush &brush : entity.brushes)
        MoveBrush(brush, by, planes);
    for (Brush &brush : entity.colorVolumes)
        MoveBrush(brush, by, planes);
    for (Patch &patch : entity.patches)
        for (DrawVert &v : patch.verts)
            v.xyz += by;
}

void JoinWorld(MapEntity &group, MapEntity &world, PlaneTable &planes, const BspContext &context) {
    MoveBack(group, planes, context);
    for (Brush &brush : group.brushes) {
        brush.textureOrigin = {};
        if (brush.opaque)
            world.brushes.push_front(std::move(brush));
        else
            world.brushes.push_back(std::move(brush));
    }
    for (Brush &brush : group.colorVolumes)
        world.colorVolumes.push_back(std::move(brush));
    world.patches.insert(world.patches.begin(), std::make_move_iterator(group.patches.begin()),
                         std::make_move_iterator(group.patches.end()));
}

} // namespace q3
