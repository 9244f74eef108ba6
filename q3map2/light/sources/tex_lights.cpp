// GPL-2.0-or-later. Texlights: .rad files.
#include "q3map2/light/sources/tex_lights.h"

#include "common/text/text.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/sources/light_quad.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::string_view kTextures = "textures/";

/// Takes the next word off the front of a line; empty at its end.
std::string_view TakeWord(std::string_view &line) {
    while (!line.empty() && IsBlank(line.front()))
        line.remove_prefix(1);
    const auto end = std::size_t(std::find_if(line.begin(), line.end(), IsBlank) - line.begin());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

/// Takes `prefix` off the front, ignoring case; whether it was there.
bool TakePrefix(std::string_view &text, std::string_view prefix) {
    if (!StartsWithNoCase(text, prefix))
        return false;
    text.remove_prefix(prefix.size());
    return true;
}

/// Lower case, with '/' between folders.
std::string PlainName(std::string_view name) {
    std::string plain = LowerCase(name);
    std::replace(plain.begin(), plain.end(), '\\', '/');
    return plain;
}

std::string WithoutFileExtension(std::string name) {
    const std::size_t dot = name.find_last_of("./");
    return dot != std::string::npos && name[dot] == '.' ? name.substr(0, dot) : name;
}

std::string MaterialName(std::string_view name) {
    std::string plain = PlainName(name);
    return plain.starts_with(kTextures) ? plain.substr(kTextures.size()) : plain;
}

/// Whether "_-12" or the like ends the name; takes it off.
bool TakeNumberAtEnd(std::string_view &name) {
    const std::size_t bar = name.find_last_of('_');
    if (bar == std::string_view::npos || !WholeInteger(name.substr(bar + 1)))
        return false;
    name = name.substr(0, bar);
    return true;
}

/// Copies of materials that a compiler made for the cube maps of a map, maps/MAP/x/y_X_Y_Z, are named by the original.
/// Empty: it is no such copy.
std::string OriginalName(std::string_view material) {
    constexpr std::string_view kMaps = "maps/";
    if (!material.starts_with(kMaps))
        return {};
    const std::size_t slash = material.find('/', kMaps.size());
    if (slash == std::string_view::npos)
        return {};
    std::string_view name = material.substr(slash + 1);
    for (int axis = 0; axis < 3; ++axis)
        if (!TakeNumberAtEnd(name))
            return {};
    return std::string(name);
}

} // namespace

/// One line of a file without its comment.
struct TexLights::Line {
    std::string_view text, file;
    int number = 0;
    std::string Where() const { return fmt::format("{}:{}", file, number); }
};

void TexLights::Read(std::string_view text, std::string_view file, bool hdr, Log &log) {
    Line line{.text = {}, .file = file};
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        line.text = text.substr(0, end);
        line.text = line.text.substr(0, line.text.find("//"));
        ++line.number;
        text.remove_prefix(std::min(end + 1, text.size()));
        ReadLine(line, hdr, log);
    }
}

void TexLights::ReadLine(const Line &line, bool hdr, Log &log) {
    std::string_view rest = line.text, word = TakeWord(rest);
    for (const bool ofHdr : {true, false})
        if (TakePrefix(word, ofHdr ? "hdr:" : "ldr:")) {
            if (ofHdr != hdr)
                return;
            if (word.empty())
                word = TakeWord(rest);
            break;
        }
    if (word.empty() && TakeWord(rest).empty())
        return;
    const bool noShadow = EqualNoCase(word, "noshadow"), textureShadow = EqualNoCase(word, "forcetextureshadow");
    if (!noShadow && !textureShadow)
        return ReadLight({rest, line.file, line.number}, word, hdr, log);
    const std::string_view name = TakeWord(rest);
    if (name.empty())
        log.Warn("line of a .rad file", "{}: {}: expected the name of a {} after it; the line is not used",
                 line.Where(), word, noShadow ? "material" : "model");
    else if (noShadow)
        noShadow_.push_back(WithoutFileExtension(MaterialName(name)));
    else
        textureShadow_.insert(WithoutFileExtension(PlainName(name)));
}

void TexLights::ReadLight(const Line &line, std::string_view name, bool hdr, Log &log) {
    const auto refuse = [&](std::string_view expected) {
        log.Warn("line of a .rad file", "{}: {}: expected {}; the line is not used", line.Where(), name, expected);
    };
    std::vector<double> numbers;
    std::string_view rest = line.text;
    for (std::string_view word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
        const std::optional<double> number = WholeNumber(word);
        if (!number)
            return refuse(fmt::format("numbers after the name, not \"{}\"", word));
        numbers.push_back(*number);
    }
    if (numbers.size() != 3 && numbers.size() != 4 && numbers.size() != 8)
        return refuse(fmt::format("a color, R G B, and a brightness, once or twice, not {} numbers", numbers.size()));
    LightQuad quad{0, 0, 0, 255};
    std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 4), quad.begin());
    // A negative number in the second four means: as the first.
    if (hdr && numbers.size() == 8 && *std::min_element(numbers.begin() + 4, numbers.end()) >= 0)
        std::copy_n(numbers.begin() + 4, 4, quad.begin());
    if (*std::min_element(quad.begin(), quad.end()) < 0)
        return refuse("numbers of at least 0");
    const Vec3d light = LinearColor(quad) * quad[3];
    if (!(MaxComponent(light) <= keys::kMaxIntensity))
        return refuse(fmt::format("light of at most {:g}", keys::kMaxIntensity));
    TexLight &entry = lights_[MaterialName(name)];
    if (!entry.where.empty())
        log.Warn("texlight given twice", "{}: {}: this line counts, not {}", line.Where(), name, entry.where);
    entry = {Vec3f(light), line.Where()};
}

const TexLight *TexLights::Find(std::string_view shader) const {
    const std::string name = MaterialName(shader);
    auto found = lights_.find(name);
    if (found == lights_.end())
        found = lights_.find(OriginalName(name));
    return found != lights_.end() ? &found->second : nullptr;
}

bool TexLights::NoShadow(std::string_view shader) const {
    const std::string name = MaterialName(shader);
    return std::any_of(noShadow_.begin(), noShadow_.end(),
                       [&](const std::string &part) { return name.find(part) != std::string::npos; });
}

bool TexLights::TextureShadow(std::string_view model) const {
    return textureShadow_.contains(WithoutFileExtension(PlainName(model)));
}

void ApplyTexLights(const TexLights &lights, SurfaceTable &table, Log &log) {
    std::set<const ShaderInfo *> lit;
    for (SurfaceEntry &entry : table) {
        const ShaderInfo &shader = *entry.shader;
        if (lights.NoShadow(shader.name))
            entry.castShadows = 0;
        const TexLight *light = lights.Find(shader.name);
        if (!light)
            continue;
        entry.texLight = light->radiance;
        if (lit.insert(&shader).second && shader.surfaceLight > 0)
            log.Print("{}: {} counts, not q3map_surfaceLight {:g}\n", shader.name, light->where, shader.surfaceLight);
    }
    if (!lit.empty())
        log.Count((long long)(lit.size()), "shaders made to shine by .rad files");
}

} // namespace q3
