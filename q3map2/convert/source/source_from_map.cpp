// GPL-2.0-or-later. Rewrites a map source with its brushes in another form.
#include "q3map2/convert/source/source_from_map.h"

#include "common/error.h"
#include "q3map2/convert/source/plane_points.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/map/map_brush.h"
#include "q3map2/map/map_primitive.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Larger differences of texture coordinates are worth a warning. Texels.
constexpr double kVisibleError = 0.01;

/// Reads one map and writes it, primitive by primitive.
class SourceConverter {
  public:
    SourceConverter(std::string_view text, std::string_view name, MapForm form, const BspContext &context)
        : context_(context), form_(form), planes_(context.options.normalEpsilon, context.options.distanceEpsilon),
          scanner_(text, name, context), primitives_(scanner_, planes_, context), writer_(form), name_(name) {}

    std::string Convert() {
        while (FindEntity())
            ConvertEntity();
        if (entityCount_ == 0)
            throw Error("{}: no entity in the map, expected the world as the first", name_);
        context_.log.Count(entityCount_, "entities");
        context_.log.Count(brushCount_, "brushes");
        context_.log.Count(patchCount_, "patches");
        return writer_.Text();
    }

  private:
    bool FindEntity();
    void ConvertEntity();
    bool ConvertPairOrPrimitive();
    void ConvertPrimitive();
    void ConvertBrush(const std::string &first);
    void ConvertPatch(bool hasTolerances);
    SideWords Words(const BrushSide &side, const SideText &text, std::span<const Vec3d> winding) const;
    void ReportError(double texels, std::string_view shader) const;

    const BspContext &context_;
    MapForm form_;
    PlaneTable planes_;
    MapScanner scanner_;
    PrimitiveReader primitives_;
    SourceWriter writer_;
    std::string_view name_;
    int entityCount_ = 0, brushCount_ = 0, patchCount_ = 0;
    int primitiveCount_ = 0; ///< brushes and patches of the entity so far
    /// The "{" of the next entity was already read, because the current one lacks a "}".
    bool nextEntityIsOpen_ = false;
};

/// Skips to the "{" of the next entity and warns of skipped text. False: end of the map.
bool SourceConverter::FindEntity() {
    scanner_.SetContext(-1, -1);
    if (nextEntityIsOpen_)
        return true;
    std::string token;
    bool warned = false;
    while (scanner_.Next(token)) {
        if (token == "{")
            return true;
        if (!warned)
            context_.log.Warn("text between entities", "{}: expected '{{' of entity {}, found '{}': it is left out",
                              scanner_.Location(), entityCount_, Shown(token));
        warned = true;
    }
    return false;
}

void SourceConverter::ConvertEntity() {
    nextEntityIsOpen_ = false;
    primitiveCount_ = 0;
    writer_.BeginEntity(entityCount_++);
    while (ConvertPairOrPrimitive()) {
    }
    writer_.EndEntity();
}

/// False: the entity ends.
bool SourceConverter::ConvertPairOrPrimitive() {
    const int entity = entityCount_ - 1;
    scanner_.SetContext(entity, -1);
    std::string key;
    if (!scanner_.Next(key)) {
        context_.log.Warn("entity without end", "{}: the file ends within entity {}, expected '}}'",
                          scanner_.Location(), entity);
        return false;
    }
    if (key == "}")
        return false;
    if (key == "{") {
        ConvertPrimitive();
        return !nextEntityIsOpen_;
    }
    writer_.WritePair(key, scanner_.NeedOnLine(fmt::format("the value of the key '{}'", Shown(key))));
    return true;
}

void SourceConverter::ConvertPrimitive() {
    scanner_.SetContext(entityCount_ - 1, primitiveCount_);
    const std::string first = scanner_.Need("a side of a brush, brushDef or patchDef2");
    if (EqualNoCase(first, "classname")) {
        scanner_.Warn("missing brace", "'{' and a class name within an entity: the next entity starts here, a '}' is "
                                       "missing");
        scanner_.PushBack();
        nextEntityIsOpen_ = true;
        return;
    }
    if (EqualNoCase(first, "terrainDef")) {
        scanner_.Warn("terrain", "terrainDef is not supported and left out");
        if (!scanner_.SkipBlock())
            scanner_.Fail("the file ends where '}' of the terrain was expected");
    } else if (EqualNoCase(first, "patchDef2") || EqualNoCase(first, "patchDef3")) {
        ConvertPatch(EqualNoCase(first, "patchDef3"));
    } else if (first == "(" || first == "}" || EqualNoCase(first, "brushDef") || EqualNoCase(first, "brushDef3")) {
        ConvertBrush(first);
    } else {
        scanner_.Fail(fmt::format("expected a side of a brush, brushDef, patchDef2 or '}}', found '{}'", Shown(first)));
    }
    ++primitiveCount_;
}

void SourceConverter::ConvertBrush(const std::string &first) {
    std::vector<SideText> texts;
    Brush brush = primitives_.ReadBrush(first, &texts);
    const bool whole =
        std::ranges::all_of(brush.sides, [](const BrushSide &side) { return side.planeNum >= 0; }) && !texts.empty();
    if (whole)
        MakeBrushWindings(brush, planes_);
    std::vector<SideWords> words;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        std::vector<Vec3d> winding;
        for (const Vec3f &p : brush.sides[i].winding)
            winding.emplace_back(p);
        words.push_back(Words(brush.sides[i], texts[i], winding));
    }
    writer_.WriteBrush(primitiveCount_, words);
    ++brushCount_;
}

SideWords SourceConverter::Words(const BrushSide &side, const SideText &text, std::span<const Vec3d> winding) const {
    SideWords words;
    words.shader = text.hasPoints ? std::string_view(text.shader) : WithoutTextures(text.shader);
    words.flags = text.flags;
    for (std::size_t i = 0; i < 3; ++i)
        words.points[i] = PointText(text.points[i]);
    if (side.planeNum < 0) { // collinear points: kept, so that readers of the result warn of them too
        words.texture = DefaultTexture(form_, {0, 0, 1}, 0.5);
        return words;
    }
    Plane plane = side.plane;
    if (!text.hasPoints) {
        const PlanePoints points = PointsOfPlane(plane, winding);
        words.points = points.points;
        plane = points.plane;
    }
    const TextureWords texture = TextureInForm(form_, {.projection = text.texture,
                                                       .plane = plane,
                                                       .normal = planes_[side.planeNum].normal,
                                                       .shader = side.shader->geometry,
                                                       .corners = winding});
    if (texture.error > kVisibleError && !side.shader->geometry.hasTexGen)
        ReportError(texture.error, text.shader);
    words.texture = texture.words;
    return words;
}

void SourceConverter::ReportError(double texels, std::string_view shader) const {
    if (std::isinf(texels))
        scanner_.Warn("texture without extent",
                      fmt::format("the texture {} has an infinite scale: it gets default axes", shader));
    else
        scanner_.Warn("sheared texture", fmt::format("the texture {} is sheared, which the classic form cannot hold: "
                                                     "it is off by {:.2f} texels; map_220 and map_bp keep it",
                                                     shader, texels));
}

void SourceConverter::ConvertPatch(bool hasTolerances) {
    PatchText text;
    std::optional<Patch> patch = primitives_.ReadPatch(&text);
    if (!patch)
        return;
    writer_.WritePatch(primitiveCount_, {.shader = std::string(WithoutTextures(text.shader)),
                                         .hasTolerances = hasTolerances,
                                         .header = std::move(text.header),
                                         .width = patch->width,
                                         .height = patch->height,
                                         .verts = std::move(patch->verts)});
    ++patchCount_;
}

} // namespace

std::string ConvertedSource(std::string_view text, std::string_view name, MapForm form, const BspContext &context) {
    return SourceConverter(text, name, form, context).Convert();
}

} // namespace q3
