// GPL-2.0-or-later. Writes the text of map sources, and rewrites sources in another form of texture axes.
#include "q3map2/convert/source/source_writer.h"

#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/map/map_brush.h"
#include "q3map2/map/map_primitive.h"
#include "q3map2/map/map_scanner.h"
#include "q3map2/map/map_texture.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Writes the text of map sources ----

namespace {

constexpr std::string_view FormName(MapForm form) {
    switch (form) {
    case MapForm::Primitive:
        return "map_bp";
    case MapForm::Valve:
        return "map_220";
    default:
        return "map";
    }
}

/// The shader name, in quotes if readers would otherwise take only a part of it, or none of it: a comment.
std::string NameToken(std::string_view name) {
    constexpr std::string_view kCommentStarts = "/#";
    const bool needsQuotes = name.empty() || kCommentStarts.find(name.front()) != kCommentStarts.npos ||
                             std::ranges::any_of(name, [](char c) { return IsBlank(c) || c == ';'; });
    return needsQuotes ? QuotedToken(name) : std::string(name);
}

} // namespace

std::string_view WithoutTexturesFolder(std::string_view shader) {
    constexpr std::string_view folder = "textures/";
    return StartsWithNoCase(shader, folder) ? shader.substr(folder.size()) : shader;
}

SourceWriter::SourceWriter(MapForm form)
    : form_(form), text_(fmt::format("// Made by q3map2-sh -convert -format {}\n", FormName(form))) {}

void SourceWriter::BeginEntity(int number) {
    text_ += fmt::format("// entity {}\n{{\n", number);
}

void SourceWriter::WritePair(std::string_view key, std::string_view value) {
    if (!key.empty() && !value.empty())
        text_ += fmt::format("\t{} {}\n", QuotedToken(key), QuotedToken(value));
}

void SourceWriter::WriteSide(const SideWords &side) {
    const std::vector<std::string> &t = side.texture;
    const std::string name = NameToken(side.shader);
    text_ += fmt::format("\t\t{} ", fmt::join(side.points, " "));
    if (form_ == MapForm::Primitive)
        text_ += fmt::format("( ( {} {} {} ) ( {} {} {} ) ) {}", t[0], t[1], t[2], t[3], t[4], t[5], name);
    else if (form_ == MapForm::Valve)
        text_ += fmt::format("{} [ {} {} {} {} ] [ {} {} {} {} ] 0 {} {}", name, t[0], t[1], t[2], t[3], t[4], t[5],
                             t[6], t[7], t[8], t[9]);
    else
        text_ += fmt::format("{} {}", name, fmt::join(t, " "));
    text_ += fmt::format(" {}\n", fmt::join(side.flags, " "));
}

void SourceWriter::WriteBrush(int number, std::span<const SideWords> sides) {
    const bool hasInnerBlock = form_ == MapForm::Primitive;
    text_ += fmt::format("\t// brush {}\n\t{{\n{}", number, hasInnerBlock ? "\tbrushDef\n\t{\n" : "");
    for (const SideWords &side : sides)
        WriteSide(side);
    text_ += hasInnerBlock ? "\t}\n\t}\n\n" : "\t}\n\n";
}

void SourceWriter::WritePatch(int number, const PatchWords &patch) {
    text_ += fmt::format("\t// patch {}\n\t{{\n\t\t{}\n\t\t{{\n\t\t\t{}\n", number,
                         patch.hasTolerances ? "patchDef3" : "patchDef2", NameToken(patch.shader));
    text_ += fmt::format("\t\t\t( {} {} {} )\n\t\t\t(\n", patch.width, patch.height, fmt::join(patch.header, " "));
    for (int column = 0; column < patch.width; ++column) {
        text_ += "\t\t\t\t(";
        for (int row = 0; row < patch.height; ++row) {
            const DrawVert &v = patch.verts[std::size_t(row) * std::size_t(patch.width) + std::size_t(column)];
            text_ += fmt::format(" ( {} {} {} {} {} )", ExactText(v.xyz.x), ExactText(v.xyz.y), ExactText(v.xyz.z),
                                 ExactText(v.st[0]), ExactText(v.st[1]));
        }
        text_ += " )\n";
    }
    text_ += "\t\t\t)\n\t\t}\n\t}\n\n";
}

void SourceWriter::EndEntity() {
    text_ += "}\n\n";
}

// ---- Rewrites a map source with its brushes in another form ----

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
    SideWords WordsOfSide(const BrushSide &side, const SideText &text, std::span<const Vec3d> winding) const;
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
    const bool hasAllPlanes =
        std::ranges::all_of(brush.sides, [](const BrushSide &side) { return side.planeNum >= 0; }) && !texts.empty();
    if (hasAllPlanes)
        MakeBrushWindings(brush, planes_);
    std::vector<SideWords> words;
    for (std::size_t i = 0; i < texts.size(); ++i) {
        std::vector<Vec3d> winding;
        for (const Vec3f &p : brush.sides[i].winding)
            winding.emplace_back(p);
        words.push_back(WordsOfSide(brush.sides[i], texts[i], winding));
    }
    writer_.WriteBrush(primitive, words);
    ++brushCount_;
}

SideWords SourceConverter::WordsOfSide(const BrushSide &side, const SideText &text,
                                       std::span<const Vec3d> winding) const {
    SideWords words;
    // Readers add "textures/" to every name, except that in brushDef3, which has no points, it may be there already.
    words.shader = text.hasPoints ? std::string_view(text.shader) : WithoutTexturesFolder(text.shader);
    words.flags = text.flags;
    for (std::size_t i = 0; i < 3; ++i)
        words.points[i] = PointText(text.points[i]);
    if (side.planeNum < 0) { // collinear points: kept, so that readers of the result warn of them too
        words.texture = DefaultTexture(form_, {0, 0, 1}, kDefaultTextureScale);
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
    writer_.WritePatch(primitive, {.shader = std::string(WithoutTexturesFolder(text.shader)),
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
