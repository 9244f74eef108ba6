// GPL-2.0-or-later. Rewrites a map source with its brushes in another form.
#include "q3map2/convert/source/source_from_map.h"

#include "q3map2/convert/source/plane_points.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/map/map_brush.h"
#include "q3map2/map/map_entities.h"
#include "q3map2/map/map_primitive.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Larger differences of texture coordinates are worth a warning. Texels.
constexpr double kVisibleError = 0.01;

/// Reads one map and writes it, primitive by primitive.
class SourceConverter : public MapEntityHandler {
  public:
    SourceConverter(std::string_view text, std::string_view name, MapForm form, const BspContext &context)
        : context_(context), form_(form), planes_(context.options.normalEpsilon, context.options.distanceEpsilon),
          scanner_(text, name, context), primitives_(scanner_, planes_, context), writer_(form), name_(name) {}

    std::string Convert() {
        ReadMapEntities(scanner_, name_, context_.log, *this);
        context_.log.Count(entityCount_, "entities");
        context_.log.Count(brushCount_, "brushes");
        context_.log.Count(patchCount_, "patches");
        return writer_.Text();
    }

  private:
    void BeginEntity(int entity) override;
    void OnPair(const std::string &key, const std::string &value) override { writer_.WritePair(key, value); }
    void OnBrush(int primitive, const std::string &first) override;
    void OnPatch(int primitive, bool hasTolerances) override;
    void EndEntity() override { writer_.EndEntity(); }
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
};

void SourceConverter::BeginEntity(int entity) {
    writer_.BeginEntity(entity);
    ++entityCount_;
}

void SourceConverter::OnBrush(int primitive, const std::string &first) {
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
    writer_.WriteBrush(primitive, words);
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

void SourceConverter::OnPatch(int primitive, bool hasTolerances) {
    PatchText text;
    std::optional<Patch> patch = primitives_.ReadPatch(&text);
    if (!patch)
        return;
    writer_.WritePatch(primitive, {.shader = std::string(WithoutTextures(text.shader)),
                                   .hasTolerances = hasTolerances,
                                   .header = std::move(text.header),
                                   .width = patch->width,
                                   .height = patch->height,
                                   .verts = std::move(patch->verts)});
    ++patchCount_;
}

} // namespace

std::string ConvertedSource(std::string_view text, std::string_view name, MapForm form, const BspContext &context) {
    RequireMapSource(text, name);
    return SourceConverter(text, name, form, context).Convert();
}

} // namespace q3
