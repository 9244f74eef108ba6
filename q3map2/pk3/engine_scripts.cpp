// GPL-2.0-or-later. Shader scripts as engines read them: which script defines a shader, which files it names, and who
// wants them.
#include "q3map2/pk3/engine_scripts.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/text/text_scan.h"
#include "q3map2/shader/shader_parse.h"

#include <algorithm>
#include <array>

namespace q3 {

// ---- Names of files or shaders that a package wants, and who wants them ----

std::string NameInPackage(std::string_view name) {
    return PlainName(name);
}

bool WantedList::Add(std::string_view name, std::string_view why, Need need) {
    std::string clean = NameInPackage(name);
    if (clean.empty())
        return false;
    if (known_.insert(LowerCase(clean)).second) {
        all_.push_back({std::move(clean), std::string(why), need});
        return true;
    }
    if (need == Need::Required)
        std::ranges::find_if(all_, [&](const Wanted &wanted) { return EqualNoCase(wanted.name, clean); })->need = need;
    return false;
}

// ---- Shader scripts, read as compilers do and checked as engines do ----

namespace {

/// What stands after a word.
enum class ImageUse {
    Drawn,   ///< an image that all engines draw
    Extra,   ///< an image that some engines draw
    Frames,  ///< a rate, then images
    Video,   ///< a video file
    Sky,     ///< the outer sky box, a height, the inner sky box
    Implicit ///< an image, or - for the one with the name of the shader
};
struct ImageWord {
    std::string_view word; ///< lower case
    ImageUse use;
};
/// Words of shaders and stages after which images stand.
constexpr std::array<ImageWord, 27> kImageWords = {{{"map", ImageUse::Drawn},
                                                    {"clampmap", ImageUse::Drawn},
                                                    {"mapcomp", ImageUse::Drawn},
                                                    {"mapnocomp", ImageUse::Drawn},
                                                    {"diffusemap", ImageUse::Drawn},
                                                    {"animmap", ImageUse::Frames},
                                                    {"clampanimmap", ImageUse::Frames},
                                                    {"animmapcomp", ImageUse::Frames},
                                                    {"animmapnocomp", ImageUse::Frames},
                                                    {"videomap", ImageUse::Video},
                                                    {"skyparms", ImageUse::Sky},
                                                    {"implicitmap", ImageUse::Implicit},
                                                    {"implicitmask", ImageUse::Implicit},
                                                    {"implicitblend", ImageUse::Implicit},
                                                    {"normalmap", ImageUse::Extra},
                                                    {"bumpmap", ImageUse::Extra},
                                                    {"normalheightmap", ImageUse::Extra},
                                                    {"normalparallaxmap", ImageUse::Extra},
                                                    {"parallaxmap", ImageUse::Extra},
                                                    {"heightmap", ImageUse::Extra},
                                                    {"specularmap", ImageUse::Extra},
                                                    {"physicalmap", ImageUse::Extra},
                                                    {"materialmap", ImageUse::Extra},
                                                    {"glowmap", ImageUse::Extra},
                                                    {"addmap", ImageUse::Extra},
                                                    {"lightfalloffimage", ImageUse::Extra},
                                                    {"reflectionmap", ImageUse::Extra}}};
constexpr std::array<std::string_view, 6> kSkySides = {"_up", "_dn", "_lf", "_rt", "_bk", "_ft"};
/// Surfaceparms of shaders that need no image of their own.
constexpr std::array<std::string_view, 3> kUndrawnParms = {"nodraw", "sky", "fog"};

const ImageWord *FindImageWord(std::string_view word) {
    const auto found = std::ranges::find_if(kImageWords, [&](const ImageWord &w) { return EqualNoCase(w.word, word); });
    return found == kImageWords.end() ? nullptr : &*found;
}

bool IsBuiltIn(std::string_view image) {
    return image.starts_with('*') || image.starts_with('$');
}

using Words = std::vector<std::string_view>;

/// Reads the body of a shader and notes the files that it names.
class BodyReader {
  public:
    BodyReader(TextScanner &scanner, EngineShader &shader) : scanner_(scanner), shader_(shader) {}

    /// After the opening brace, to the closing one or the end.
    void Read() {
        std::string_view word;
        for (int depth = 1; depth > 0 && scanner_.Next(word);) {
            if (word == "{" || word == "}")
                depth += word == "{" ? 1 : -1;
            else
                ReadLine(word);
        }
    }

  private:
    void ReadLine(std::string_view first) {
        Words words{first};
        for (std::string_view word; scanner_.NextOnLine(word);) {
            if (word == "{" || word == "}") {
                scanner_.PushBack();
                break;
            }
            words.push_back(word);
        }
        for (std::size_t i = 0; i < words.size(); ++i)
            i += UseWord(words, i);
    }

    /// Notes what a word asks for. Returns how many words after it belong to it.
    std::size_t UseWord(const Words &words, std::size_t at) {
        const std::size_t rest = words.size() - at - 1;
        if (EqualNoCase(words[at], "fogparms")) {
            shader_.drawsWithoutImage = true;
            return rest;
        }
        if (EqualNoCase(words[at], "surfaceparm") && rest > 0) {
            for (const std::string_view parm : kUndrawnParms)
                shader_.drawsWithoutImage |= EqualNoCase(words[at + 1], parm);
            return 1;
        }
        const ImageWord *known = FindImageWord(words[at]);
        return known == nullptr || rest == 0 ? 0 : UseImages(known->use, words, at);
    }

    std::size_t UseImages(ImageUse use, const Words &words, std::size_t at) {
        const std::size_t rest = words.size() - at - 1;
        const std::string_view first = words[at + 1];
        switch (use) {
        case ImageUse::Frames:
            for (std::size_t i = at + 2; i < words.size(); ++i)
                AddImage(words[i]);
            return rest;
        case ImageUse::Sky:
            AddSky(first, shader_.images);
            if (constexpr std::size_t kInner = 3; rest >= kInner)
                AddSky(words[at + kInner], shader_.extraImages);
            return rest;
        case ImageUse::Video: {
            std::string video = NameInPackage(first);
            if (video.find('/') == std::string::npos)
                video = "video/" + video;
            if (video.find('.') == std::string::npos)
                video += ".roq";
            shader_.videos.push_back(std::move(video));
            return 1;
        }
        case ImageUse::Implicit:
            AddImage(first == "-" ? shader_.name : first);
            return 1;
        case ImageUse::Extra:
            if (!IsBuiltIn(first))
                shader_.extraImages.push_back(ImageName(first));
            return 1;
        case ImageUse::Drawn:
            break;
        }
        AddImage(first);
        return 1;
    }

    void AddImage(std::string_view image) {
        if (IsBuiltIn(image))
            shader_.drawsWithoutImage = true;
        else
            shader_.images.push_back(ImageName(image));
    }

    void AddSky(std::string_view box, std::vector<std::string> &images) {
        shader_.drawsWithoutImage = true;
        if (box != "-" && !EqualNoCase(box, "full")) // words for a sky without images
            for (const std::string_view side : kSkySides)
                images.push_back(ImageName(box) + std::string(side));
    }

    TextScanner &scanner_;
    EngineShader &shader_;
};

/// The words of a line of a stripped shader with the images of its directive, if it has any, as .tga.
std::string WithTga(std::string_view line) {
    constexpr std::array<std::string_view, 4> kRenamed = {"map", "clampmap", "animmap", "clampanimmap"};
    const std::size_t indent = std::min(line.find_first_not_of('\t'), line.size());
    std::string result(line.substr(0, indent));
    constexpr auto kNoImages = std::size_t(-1);
    std::size_t firstImage = 0, number = 0; // numbers of words in the line
    for (std::string_view rest = line.substr(indent); !rest.empty(); ++number) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        const std::string_view word = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (number == 0) {
            const bool isRenamed = std::ranges::any_of(kRenamed, [&](auto w) { return EqualNoCase(w, word); });
            const bool hasRate = EqualNoCase(word, "animmap") || EqualNoCase(word, "clampanimmap");
            firstImage = !isRenamed ? kNoImages : hasRate ? 2 : 1;
        }
        result += number > 0 ? " " : "";
        result += number >= firstImage && !IsBuiltIn(word) ? ImageName(word) + ".tga" : std::string(word);
    }
    return result;
}

/// The check that ioquake3 and engines derived from it make before they use a script: names and blocks must alternate,
/// and only // and /* */ are comments. Returns what is wrong; empty: nothing.
std::string FaultOf(std::string_view name, const std::string &text) {
    TextScanner scanner(text, std::string(name), {}, TextDialect::Engine);
    try {
        for (std::string shader, word; scanner.Next(shader);) {
            const std::string place = scanner.Location();
            const auto fault = [&](std::string_view found) {
                return fmt::format("{}: {}: {}{}", place, shader, found,
                                   shader.starts_with('#') || shader.starts_with(';')
                                       ? "; engines know only // and /* */ as comments"
                                       : "");
            };
            if (!scanner.Next(word))
                return fault("expected '{' after the name of a shader, found the end of the file");
            if (word != "{")
                return fault(fmt::format("expected '{{' after the name of a shader, found {}", word));
            for (int depth = 1; depth > 0;) {
                if (!scanner.Next(word))
                    return fault("this shader has no closing brace");
                depth += word == "{" ? 1 : word == "}" ? -1 : 0;
            }
        }
    } catch (const Error &error) {
        return error.what();
    }
    return {};
}

} // namespace

std::string ImageName(std::string_view name) {
    constexpr std::array<std::string_view, 8> kExtensions = {".tga", ".jpg", ".jpeg", ".png",
                                                             ".dds", ".ktx", ".crn",  ".webp"};
    std::string clean = NameInPackage(name);
    for (const std::string_view extension : kExtensions)
        if (clean.size() > extension.size() &&
            EqualNoCase(std::string_view(clean).substr(clean.size() - extension.size()), extension)) {
            clean.resize(clean.size() - extension.size());
            break;
        }
    return clean;
}

void EngineScripts::Read(std::string_view name, std::string text, Log &log) {
    scripts_.push_back({std::string(name), {}, FaultOf(name, text)});
    try {
        TextScanner scanner(std::move(text), std::string(name));
        for (std::string shaderName, brace; scanner.Next(shaderName);) {
            if (!scanner.Next(brace))
                break;
            if (brace != "{") {
                scanner.PushBack(); // perhaps the name of the next shader
                continue;
            }
            EngineShader shader;
            shader.name = NameInPackage(shaderName);
            shader.script = scripts_.size() - 1;
            const char *begin = scanner.Unread().data();
            BodyReader(scanner, shader).Read();
            shader.body.assign(begin, scanner.Unread().data());
            scripts_.back().shaders.push_back(shader.name);
            shaders_[LowerCase(shader.name)].push_back(std::move(shader));
        }
    } catch (const Error &error) {
        log.Warn("damaged shader script", "{}; the rest of the script is not read", error.what());
    }
}

std::span<const EngineShader> EngineScripts::Find(std::string_view shader) const {
    const auto found = shaders_.find(LowerCase(NameInPackage(shader)));
    return found == shaders_.end() ? std::span<const EngineShader>() : std::span(found->second);
}

std::string StrippedText(const EngineShader &shader) {
    const std::string tidy = TidyBody(shader.body);
    std::string text = shader.name + '\n';
    for (std::string_view rest = tidy; !rest.empty();) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        text += WithTga(rest.substr(0, end)) + '\n';
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return text;
}

} // namespace q3
