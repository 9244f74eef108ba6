// GPL-2.0-or-later. Finds scripts and images, and hands out complete shaders.
#include "q3map2/shader/shader_library.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/text/text.h"
#include "q3map2/shader/image_formats.h"
#include "q3map2/shader/shader_parse.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <unordered_map>
#include <utility>

namespace q3 {

namespace {

constexpr int kDefaultImageSize = 64;                  ///< texels a side
constexpr std::string_view kDefaultImage = "*default"; ///< name of the white image
constexpr std::string_view kMissingName = "missing";   ///< of the shader in place of one without a name
constexpr std::string_view kNoShader = "noshader";     ///< of brush sides without a shader: it has no image
constexpr std::uint32_t kSeeThrough = C_ALPHASHADOW | C_LIGHTFILTER;

constexpr std::string_view kCrunch = ".crn"; ///< extension of images of which only the size is read

/// Whether direct light needs the image: the shader emits or transmits light.
bool NeedsImage(const ShaderInfo &info) {
    return info.surfaceLight != 0 || !info.suns.empty() || !info.skyLights.empty() ||
           (info.compileFlags & kSeeThrough) != 0;
}

/// Whether bounced light needs the image for its colors.
bool Reflects(const ShaderInfo &info) {
    return info.bounceScale > 0 && (info.compileFlags & C_SKY) == 0;
}

std::shared_ptr<const Image> WhiteImage() {
    Image image{kDefaultImageSize, kDefaultImageSize, {}};
    image.rgba.assign(4 * kDefaultImageSize * kDefaultImageSize, 255);
    return std::make_shared<const Image>(std::move(image));
}

/// 0 to 255.
Vec3f MeanColor(const Image &image) {
    std::array<std::uint64_t, 3> sum{};
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum[channel] += image.rgba[i + channel];
    return Vec3f(Vec3d{double(sum[0]), double(sum[1]), double(sum[2])} / (double(image.rgba.size()) / 4));
}

/// The images that may give a shader its light, the first that exists counts. Without extension; none is empty.
std::vector<std::string> LightImageNames(const ParsedShader &shader) {
    std::vector<std::string> names{shader.lightImage, shader.editorImage, shader.info.name, shader.implicitImage};
    std::erase(names, "");
    return names;
}

/// The images of the six sides of a sky.
std::vector<std::string> SkyImageNames(const ShaderInfo &shader) {
    std::vector<std::string> names;
    for (const char *side : kSkyImageSides)
        names.push_back(shader.skyImageBase + side);
    return names;
}

/// Names of the shaders that a script defines.
std::vector<std::string> NamesInScript(TextScanner scanner) {
    std::vector<std::string> names;
    int depth = 0;
    for (std::string word, before; scanner.Next(word); before = word) {
        if (word == "{" && depth++ == 0)
            names.push_back(before);
        if (word == "}")
            depth = std::max(0, depth - 1);
    }
    return names;
}

} // namespace

struct ShaderLibrary::State {
    const VirtualFileSystem &vfs;
    Log &log;
    ShaderTable table;
    std::unordered_map<std::string, std::shared_ptr<const Image>> images{}; ///< by lower-case name; null: not found
    std::unordered_map<const Image *, Vec3f> means{};                       ///< mean colors of some of `images`
    std::shared_ptr<const Image> white = WhiteImage();
    std::vector<std::string> unlistedScripts{};                             ///< that shaderlist.txt leaves out
    std::optional<std::unordered_map<std::string, std::string>> unlisted{}; ///< their shaders, lower case: the script

    /// A scanner of the bytes of that file, which finds what `$include` names.
    TextScanner Open(std::string_view file, const std::vector<std::byte> &bytes) const;
    std::vector<std::string> ScriptNames(const std::string &folder) const;
    void ReadScripts();
    void WarnIfUnlisted(const std::string &name);
    void ReadCustomParms();
    std::shared_ptr<const Image> ReadImage(const std::string &name) const;
    struct ImageBytes {
        std::string name; ///< of the file
        std::vector<std::byte> bytes;
    };
    struct ImageAhead {
        std::string name; ///< lower case; empty: none
        std::shared_ptr<const Image> image{};
        Vec3f mean{};
    };
    /// How VirtualFileSystem reads a file: with its warnings, or without them.
    using Read = std::optional<std::vector<std::byte>> (VirtualFileSystem::*)(std::string_view) const;
    std::vector<std::string> FileNames(const std::string &image) const {
        return ImageFileNames(image, table.GameRules().imageFiles);
    }
    std::optional<ImageBytes> FindBytes(const std::string &name, Read read = &VirtualFileSystem::Read) const;
    Image Decoded(const std::string &name, const ImageBytes &file, Read read) const;
    std::shared_ptr<const Image> FindImage(const std::string &name) const;
    std::string FileOfImage(const std::string &name) const;
    void WarnIfOpenExr(const std::string &image) const;
    void AddJpegAlpha(const std::string &name, Read read, Image &image) const;
    const std::shared_ptr<const Image> &CachedImage(std::string_view name);
    std::shared_ptr<const Image> LightImageOf(const ParsedShader &shader);
    ImageAhead ReadFirst(const std::vector<std::string> &names) const;
    void ReadAhead(const std::vector<const ParsedShader *> &shaders, const JobPool &jobs);
    void Complete(ParsedShader &shader);
    std::optional<std::array<int, 2>> ImageSize(const std::string &name) const;
    std::string ImageFile(const ParsedShader &shader) const;
    bool HasNormalImage(const ParsedShader &shader) const;
    void FindTextureSize(ParsedShader &shader);
};

TextScanner ShaderLibrary::State::Open(std::string_view file, const std::vector<std::byte> &bytes) const {
    return TextScanner(std::string(AsText(bytes)), std::string(file),
                       [this](std::string_view name) -> std::optional<std::string> {
                           const auto included = vfs.Read(name);
                           if (!included) {
                               log.Warn("include not found", "$include {}: no such file", name);
                               return std::nullopt;
                           }
                           return std::string(AsText(*included));
                       });
}

/// Full names of the scripts to read, in order, each once.
std::vector<std::string> ShaderLibrary::State::ScriptNames(const std::string &folder) const {
    const std::string list = folder + "/shaderlist.txt";
    std::vector<std::string> names;
    std::set<std::string> known; // lower case
    const auto add = [&](std::string name) {
        if (known.insert(LowerCase(name)).second)
            names.push_back(std::move(name));
    };
    for (const std::vector<std::byte> &bytes : vfs.ReadAll(list)) {
        try {
            TextScanner scanner = Open(list, bytes);
            for (std::string word; scanner.Next(word);)
                add(folder + "/" + (WithoutExtension(word) == word ? word + ".shader" : word));
        } catch (const Error &error) {
            log.Warn("damaged shader list", "{}", error.what());
        }
    }
    if (names.empty()) {
        log.Print("{} names no scripts: all scripts of {} are read\n", list, folder);
        for (const std::string &name : vfs.List(folder, ".shader"))
            add(folder + "/" + name);
    }
    return names;
}

/// Two lists of names and hexadecimal bits: content flags, then surface flags.
void ShaderLibrary::State::ReadCustomParms() {
    const std::string file = std::string(table.GameRules().shaderDir) + "/custinfoparms.txt";
    const auto bytes = vfs.Read(file);
    if (!bytes) {
        log.Warn("no custom surfaceparms",
                 "{}: no such file, which -custinfoparms asks for; only the surfaceparms of -game {} are known", file,
                 table.GameRules().name);
        return;
    }
    TextScanner scanner = Open(file, *bytes);
    enum class Flags { Content, Surface };
    for (const Flags list : {Flags::Content, Flags::Surface}) {
        std::string word, value;
        if (!scanner.Next(word) || word != "{")
            throw Error("{}: expected two lists in braces, content flags and surface flags", scanner.Location());
        while (scanner.Next(word) && word != "}") {
            if (!scanner.Next(value) || value == "}")
                throw Error("{}: expected a hexadecimal number after {}", scanner.Location(), word);
            const auto bits = std::uint32_t(std::strtoull(value.c_str(), nullptr, 16));
            if (!table.AddCustomParm(word, list == Flags::Content ? bits : 0, list == Flags::Surface ? bits : 0))
                throw Error("{}: more than {} parms", scanner.Location(), ShaderTable::kMaxCustomParms);
        }
    }
}

/// Warns if a shader that no listed script defines is in a script that shaderlist.txt does not name.
void ShaderLibrary::State::WarnIfUnlisted(const std::string &name) {
    if (unlistedScripts.empty())
        return;
    if (!unlisted) {
        unlisted.emplace();
        for (const std::string &script : unlistedScripts)
            if (const auto bytes = vfs.Read(script)) {
                try {
                    for (const std::string &shader : NamesInScript(TextScanner(std::string(AsText(*bytes)), script)))
                        unlisted->try_emplace(LowerCase(PlainName(shader)), script);
                } catch (const Error &) { // the rest of a damaged script: it is not read for its shaders
                }
            }
    }
    if (const auto found = unlisted->find(LowerCase(PlainName(name))); found != unlisted->end())
        log.Warn("script not listed",
                 "shader {}: {} defines it, but that script is not read, because {}/shaderlist.txt does not list it",
                 name, found->second, table.GameRules().shaderDir);
}

void ShaderLibrary::State::ReadScripts() {
    const std::string folder(table.GameRules().shaderDir);
    const std::vector<std::string> names = ScriptNames(folder);
    const std::set<std::string> listed = [&] {
        std::set<std::string> lower;
        for (const std::string &name : names)
            lower.insert(LowerCase(PlainName(name)));
        return lower;
    }();
    constexpr std::string_view kOfLightStage = "q3map2_"; // scripts that it generates for engines
    for (const std::string &name : vfs.List(folder, ".shader"))
        if (const std::string script = folder + "/" + name;
            !listed.contains(LowerCase(script)) && !StartsWithNoCase(name, kOfLightStage))
            unlistedScripts.push_back(script);
    for (const std::string &name : names) {
        const auto bytes = vfs.Read(name);
        if (!bytes) {
            log.Warn("shader script not found", "{}: the script is listed but not there", name);
            continue;
        }
        if (log.IsVerbose())
            log.Verbose("entering {}\n", vfs.Location(name));
        try {
            TextScanner scanner = Open(name, *bytes);
            ParseShaderScript(scanner, table, log);
        } catch (const Error &error) {
            log.Warn("damaged shader script", "{}; the rest of the script is not read", error.what());
        }
    }
}

/// JPEG has no alpha: games take it from a second image.
void ShaderLibrary::State::AddJpegAlpha(const std::string &name, Read read, Image &image) const {
    const std::string alphaName = name + "_alpha.jpg";
    const auto alphaBytes = (vfs.*read)(alphaName);
    if (!alphaBytes)
        return;
    const Image alpha = DecodeJpeg(*alphaBytes, alphaName);
    if (alpha.width == image.width && alpha.height == image.height)
        for (std::size_t i = 0; i < image.rgba.size(); i += 4)
            image.rgba[i + 3] = alpha.rgba[i + 2]; // its blue
}

/// The first file in which the image exists.
std::optional<ShaderLibrary::State::ImageBytes> ShaderLibrary::State::FindBytes(const std::string &name,
                                                                                Read read) const {
    for (std::string &file : FileNames(name))
        if (auto bytes = (vfs.*read)(file))
            return ImageBytes{std::move(file), std::move(*bytes)};
    return std::nullopt;
}

/// To be called for an image that no other file has.
void ShaderLibrary::State::WarnIfOpenExr(const std::string &image) const {
    if (const std::string file = image + ".exr"; vfs.Exists(file))
        log.Warn("OpenEXR image",
                 "{}: game files in this format are not read; save the image as .tga or .png next to it", file);
}

/// `name`: without extension. Error: the file is damaged.
Image ShaderLibrary::State::Decoded(const std::string &name, const ImageBytes &file, Read read) const {
    Image image = FindImageFormat(file.name)->decode(file.bytes, file.name);
    if (EndsWithNoCase(file.name, ".jpg"))
        AddJpegAlpha(name, read, image);
    return image;
}

/// Decodes the first existing file; null: none. Error: it is damaged.
std::shared_ptr<const Image> ShaderLibrary::State::FindImage(const std::string &name) const {
    const auto found = FindBytes(name);
    if (!found) {
        WarnIfOpenExr(name);
        return nullptr;
    }
    Image image = Decoded(name, *found, &VirtualFileSystem::Read);
    if (EndsWithNoCase(found->name, kCrunch))
        log.Warn("colors of Crunch images",
                 "{}: of .crn files only the size is read, middle gray (128) stands for the colors; save the image as "
                 ".tga or .png next to it",
                 vfs.Location(found->name));
    return std::make_shared<const Image>(std::move(image));
}

std::shared_ptr<const Image> ShaderLibrary::State::ReadImage(const std::string &name) const {
    if (name == kDefaultImage)
        return white;
    try {
        return FindImage(name);
    } catch (const Error &error) {
        log.Warn("damaged image", "{}", error.what());
        return nullptr;
    }
}

const std::shared_ptr<const Image> &ShaderLibrary::State::CachedImage(std::string_view name) {
    const auto [slot, isNew] = images.try_emplace(LowerCase(name));
    if (isNew)
        slot->second = ReadImage(std::string(name));
    return slot->second;
}

/// The image that gives the shader its light, or null.
std::shared_ptr<const Image> ShaderLibrary::State::LightImageOf(const ParsedShader &shader) {
    for (const std::string &name : LightImageNames(shader))
        if (auto image = CachedImage(name))
            return image;
    return nullptr;
}

/// The first of the images that exists, unless there is something to warn of: then none.
ShaderLibrary::State::ImageAhead ShaderLibrary::State::ReadFirst(const std::vector<std::string> &names) const {
    constexpr Read kStrictly = &VirtualFileSystem::ReadStrictly;
    try {
        for (const std::string &name : names)
            if (const auto found = FindBytes(name, kStrictly)) {
                if (EndsWithNoCase(found->name, kCrunch))
                    return {};
                auto image = std::make_shared<const Image>(Decoded(name, *found, kStrictly));
                const Vec3f mean = MeanColor(*image);
                return {LowerCase(name), std::move(image), mean};
            }
    } catch (const Error &) { // Get warns of it
    }
    return {};
}

/// Reads light images, and those of skies that give light.
void ShaderLibrary::State::ReadAhead(const std::vector<const ParsedShader *> &shaders, const JobPool &jobs) {
    std::vector<std::vector<std::string>> wanted;
    std::set<std::string> known; // the first name of each, lower case
    const auto want = [&](std::vector<std::string> names) {
        if (!names.empty() && !images.contains(LowerCase(names.front())) &&
            known.insert(LowerCase(names.front())).second)
            wanted.push_back(std::move(names));
    };
    for (const ParsedShader *shader : shaders) {
        const auto samplesSky = [](const SkyLightDirective &sky) { return sky.sampleColor; };
        if (!shader->info.skyImageBase.empty() && std::ranges::any_of(shader->info.skyLights, samplesSky))
            for (std::string &side : SkyImageNames(shader->info))
                want({std::move(side)});
        want(LightImageNames(*shader));
    }
    std::vector<ImageAhead> ahead(wanted.size());
    jobs.For(std::int64_t(wanted.size()),
             [&](std::int64_t i, int) { ahead[std::size_t(i)] = ReadFirst(wanted[std::size_t(i)]); });
    for (ImageAhead &one : ahead)
        if (!one.name.empty()) {
            means[one.image.get()] = one.mean;
            images.try_emplace(std::move(one.name), std::move(one.image));
        }
}

void ShaderLibrary::State::Complete(ParsedShader &shader) {
    ShaderInfo &info = shader.info;
    const bool isDrawn = (info.compileFlags & C_NODRAW) == 0;
    info.lightImage = isDrawn ? LightImageOf(shader) : nullptr;
    info.imageFound = info.lightImage != nullptr;
    if (isDrawn && shader.lightImageGiven && !CachedImage(shader.lightImage))
        log.Warn("light image",
                 "{}: q3map_lightImage {}: no image of that name can be read, the light has the color of {}", info.name,
                 shader.lightImage,
                 shader.colorGiven ? "q3map_lightRGB"
                 : info.imageFound ? "another image"
                                   : "white");
    if (!info.imageFound) {
        if (isDrawn)
            log.Verbose("shader {}: couldn't find image\n", info.name);
        info.lightImage = white;
    }
    if (shader.colorGiven) {
        info.averageColor = info.color * 255;
    } else {
        const auto known = means.find(info.lightImage.get());
        info.averageColor = known != means.end() ? known->second : MeanColor(*info.lightImage);
        info.color = NormalizeColor(info.averageColor);
    }
    shader.imagesReady = true;
}

/// Size of the file that FindImage decodes; nothing if there is none or it is damaged.
std::optional<std::array<int, 2>> ShaderLibrary::State::ImageSize(const std::string &name) const {
    const auto found = FindBytes(name);
    return found ? FindImageFormat(found->name)->size(found->bytes) : std::nullopt;
}

/// Name of the file with its extension; empty: there is none.
std::string ShaderLibrary::State::FileOfImage(const std::string &name) const {
    if (!name.empty())
        for (std::string &file : FileNames(name))
            if (vfs.Exists(file))
                return std::move(file);
    return {};
}

std::string ShaderLibrary::State::ImageFile(const ParsedShader &shader) const {
    if ((shader.info.compileFlags & C_NODRAW) != 0)
        return {};
    for (const std::string &name : {shader.editorImage, shader.info.name, shader.implicitImage, shader.lightImage})
        if (std::string file = FileOfImage(name); !file.empty())
            return file;
    return {};
}

/// The normal map beside the image of a shader, as engines find it: ioquake3's and OpenJK's second renderers (_n),
/// DarkPlaces and FTE (_norm, _local).
bool ShaderLibrary::State::HasNormalImage(const ParsedShader &shader) const {
    for (const std::string &name : {shader.lightImage, shader.implicitImage, shader.editorImage, shader.info.name})
        for (const std::string_view suffix : {"_n", "_norm", "_local"})
            if (!name.empty() && !FileOfImage(name + std::string(suffix)).empty())
                return true;
    return false;
}

/// Texture axes of brush sides count texels of the editor image, whose size may differ from the light image's.
void ShaderLibrary::State::FindTextureSize(ParsedShader &shader) {
    GeometryDirectives &geometry = shader.info.geometry;
    std::array<int, 2> size{kDefaultImageSize, kDefaultImageSize};
    if ((shader.info.compileFlags & C_NODRAW) == 0 && shader.info.name != kNoShader) {
        bool found = false;
        for (const std::string &name :
             {shader.editorImage, shader.info.name, shader.implicitImage, shader.lightImage}) {
            if (found || name.empty())
                continue;
            if (const auto known = ImageSize(name)) {
                size = *known;
                found = true;
            } else {
                WarnIfOpenExr(name);
            }
        }
        const bool named = !shader.editorImage.empty() || !shader.implicitImage.empty() || !shader.lightImage.empty();
        if (!found && (named || !shader.builtInImage)) // built-in images have no file
            log.Warn("image not found", "shader {}: couldn't find image", shader.info.name);
    }
    if (!geometry.textureSizeGiven) {
        geometry.textureWidth = size[0];
        geometry.textureHeight = size[1];
    }
    if (geometry.terrain && !geometry.hasTexGen) { // two repeats for each size of the image in game units
        geometry.hasTexGen = true;
        geometry.texGen = {Vec3f{2.0f / float(geometry.textureWidth), 0, 0},
                           Vec3f{0, 2.0f / float(geometry.textureHeight), 0}};
    }
}

ShaderLibrary::ShaderLibrary(const VirtualFileSystem &vfs, const Game &game, const ShaderOptions &options, Log &log)
    : state_(new State{.vfs = vfs, .log = log, .table = ShaderTable(game, options)}) {
    if (options.customInfoParms)
        state_->ReadCustomParms();
    state_->ReadScripts();
}
ShaderLibrary::~ShaderLibrary() = default;
ShaderLibrary::ShaderLibrary(ShaderLibrary &&) noexcept = default;

const ShaderInfo &ShaderLibrary::Get(std::string_view name) {
    if (name.empty())
        state_->log.Warn("shader without a name", "a shader has no name, {} is used", kMissingName);
    ParsedShader &shader = state_->table.FindOrAdd(name.empty() ? kMissingName : name, state_->log);
    const ShaderOptions &options = state_->table.Options();
    if (!shader.lookedUp) {
        if (!shader.info.defined)
            state_->WarnIfUnlisted(shader.info.name);
        if (const auto body = std::exchange(shader.body, std::nullopt))
            shader.info.scriptText = TidyBody(*body);
        state_->table.ApplyGlobalFlags(shader.info);
        if (options.imageSizes)
            state_->FindTextureSize(shader);
    }
    shader.lookedUp = true;
    if (!shader.info.lightImage)
        shader.info.lightImage = state_->white;
    const bool needsImage = options.imageSizes ? !shader.info.geometry.flareShader.empty() : NeedsImage(shader.info);
    if (!shader.imagesReady && needsImage)
        state_->Complete(shader);
    return shader.info;
}

const ShaderInfo &ShaderLibrary::GetWithImage(std::string_view name) {
    const ShaderInfo &info = Get(name);
    ParsedShader &shader = state_->table.FindOrAdd(info.name, state_->log);
    if (!shader.imagesReady)
        state_->Complete(shader);
    return shader.info;
}

void ShaderLibrary::ReadAhead(std::span<const std::string> names, const JobPool &jobs) {
    Log quiet(Log::Nowhere()); // Get warns
    std::vector<const ParsedShader *> shaders;
    for (const std::string &name : names)
        if (const ParsedShader *shader = state_->table.Find(name, quiet);
            shader && (shader->info.compileFlags & C_NODRAW) == 0 && NeedsImage(shader->info))
            shaders.push_back(shader);
    state_->ReadAhead(shaders, jobs);
}

std::string ShaderLibrary::ImageFile(std::string_view name) {
    return state_->ImageFile(state_->table.FindOrAdd(Get(name).name, state_->log));
}

bool ShaderLibrary::HasNormalMap(std::string_view name) {
    const ShaderInfo &info = Get(name);
    if (info.lightmap.rnm)
        return *info.lightmap.rnm;
    return info.normalMapStage || !info.lightmap.normalImage.empty() || !info.lightmap.ssbumpImage.empty() ||
           state_->HasNormalImage(state_->table.FindOrAdd(info.name, state_->log));
}

void ShaderLibrary::SetDefaultFlags(std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags) {
    if (name.empty() || (surfaceFlags | contentFlags) == 0)
        return;
    ParsedShader &shader = state_->table.FindOrAdd(name, state_->log);
    if (shader.info.defined)
        return;
    // Of records of one name, what all have counts: single surfaces have flags of their own, such as curves that are
    // there for collision only. Contents are those of the first.
    const bool hadBspFlags = std::exchange(shader.hasBspFlags, true);
    if (hadBspFlags) {
        surfaceFlags &= shader.info.surfaceFlags;
        contentFlags = shader.info.contentFlags;
    }
    shader.info.surfaceFlags = surfaceFlags;
    shader.info.contentFlags = contentFlags;
    shader.info.compileFlags = state_->table.GameRules().CompileFlagsOf(surfaceFlags, contentFlags);
}

std::shared_ptr<const Image> ShaderLibrary::LoadImage(std::string_view nameWithoutExtension) {
    return state_->CachedImage(nameWithoutExtension);
}

void ShaderLibrary::ReleaseImages(KeptImages kept, const JobPool &jobs) {
    const auto isReflecting = [kept](const ShaderInfo &info) {
        return kept == KeptImages::OfReflectors && Reflects(info);
    };
    std::vector<const ParsedShader *> added;
    state_->table.ForEach([&](const ParsedShader &shader) {
        if (isReflecting(shader.info) && shader.lookedUp && !shader.imagesReady &&
            (shader.info.compileFlags & C_NODRAW) == 0)
            added.push_back(&shader);
    });
    state_->ReadAhead(added, jobs);
    state_->table.ForEach([&](ParsedShader &shader) {
        const bool isReflector = isReflecting(shader.info);
        if (isReflector && shader.lookedUp && !shader.imagesReady)
            state_->Complete(shader);
        if (shader.imagesReady && !isReflector && (shader.info.compileFlags & kSeeThrough) == 0)
            shader.info.lightImage = state_->white;
    });
    state_->images.clear();
    state_->means.clear();
}

std::size_t ShaderLibrary::DefinedCount() const {
    return state_->table.DefinedCount();
}

} // namespace q3
