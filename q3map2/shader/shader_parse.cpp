// GPL-2.0-or-later. From script text to shaders, before any image is read.
#include "q3map2/shader/shader_parse.h"

#include "common/text/text.h"
#include "q3map2/shader/shader_directive.h"
#include "q3map2/shader/shader_text.h"

#include <vector>

namespace q3 {

namespace {

constexpr std::size_t kMaxName = 63;
constexpr std::string_view kHiddenSuffix = ":q3map"; // hides a definition from the engine

/// Whether the word in lower case equals `lower`.
bool IsWord(std::string_view word, std::string_view lower) {
    return word.size() == lower.size() && (word[0] | 0x20) == lower[0] && EqualNoCase(word, lower);
}

class ScriptParser {
  public:
    ScriptParser(TextScanner &scanner, ShaderTable &table, Log &log)
        : scanner_(scanner), hasIncludes_(scanner.HasIncludes()), table_(table), log_(log) {}

    void ParseScript() {
        for (std::string_view token; scanner_.Next(token);) {
            const std::string name(token);
            std::string_view brace;
            if (!scanner_.Next(brace)) {
                WarnSyntax(name, "the end of the file");
                return;
            }
            if (brace == "{") {
                ParseShader(name);
            } else {
                WarnSyntax(name, brace);
                scanner_.PushBack(); // perhaps the name of the next shader
            }
        }
    }

  private:
    using Words = std::vector<std::string_view>;
    void WarnSyntax(std::string_view name, std::string_view found) {
        log_.Warn("shader syntax", "{}: expected {{ after the shader name {}, found {}",
                  scanner_.TokenLocation().Text(), name, found);
    }
    void ParseShader(std::string_view name);
    void ParseStage();
    void ParseDirective(std::string_view word);
    void RunDirective(const ShaderDirective &directive, std::string_view word);
    bool NoImageYet() const {
        return shader_->editorImage.empty() && shader_->lightImage.empty() && shader_->implicitImage.empty();
    }

    ShaderTextScanner scanner_;
    bool hasIncludes_;
    ShaderTable &table_;
    Log &log_;
    std::unique_ptr<ParsedShader> shader_;
    Words words_; ///< arguments of the current directive
};

void ScriptParser::ParseShader(std::string_view name) {
    const bool isHidden = name.ends_with(kHiddenSuffix);
    if (isHidden)
        name.remove_suffix(kHiddenSuffix.size());
    if (name.size() > kMaxName)
        log_.Warn("long shader name", "{}: shader name {} is longer than the {} bytes that a map can hold",
                  scanner_.TokenLocation().Text(), name, kMaxName);
    shader_.reset(new ParsedShader(table_.MakeDefault(name))); // constructs the default on the heap, without a copy
    shader_->info.defined = true;
    bool hasStages = false;
    const char *bodyBegin = scanner_.Unread().data();
    if (hasIncludes_)
        scanner_.Record();
    std::string_view word;
    while (scanner_.Next(word) && word != "}") {
        if (word == "{") {
            hasStages = true;
            ParseStage();
        } else
            ParseDirective(word);
    }
    const LightmapDirectives &lightmap = shader_->info.lightmap;
    if (!lightmap.normalImage.empty() && !lightmap.ssbumpImage.empty())
        log_.Warn("two normal maps", "{}: shader {}: q3map_normalImage and q3map_ssbumpImage, the latter is not used",
                  scanner_.TokenLocation().Text(), name);
    WarnOfLateLines(*shader_, log_);
    shader_->info.scriptText.clear(), shader_->body.reset();
    // A hidden definition without stages only holds directives for the compiler. The engine draws another definition
    // of the same name, so this text is not kept.
    if (isHidden && !hasStages)
        scanner_.TakeText();
    else if (hasIncludes_)
        shader_->info.scriptText = scanner_.TakeText();
    else
        shader_->body.emplace(bodyBegin, scanner_.Unread().data());
    table_.Define(std::move(shader_));
}

/// Reads names of images only. Blocks do not nest, and line ends have no meaning here.
void ScriptParser::ParseStage() {
    std::string_view word;
    std::string image; // the first of the stage
    bool afterStage = false, isNormalMap = false;
    while (scanner_.Next(word) && word != "}") {
        const StageWord use = FindStageWord(word);
        shader_->info.normalMapStage |= use == StageWord::NormalMap;
        isNormalMap |= use == StageWord::NormalMap && afterStage;
        afterStage = IsWord(word, "stage");
        if (use != StageWord::Image && use != StageWord::Frames)
            continue;
        const int arguments = use == StageWord::Frames ? 2 : 1; // a rate, then the first frame
        bool more = true;
        for (int i = 0; i < arguments && more && word != "}"; ++i)
            more = scanner_.Next(word);
        if (!more || word == "}")
            break;
        const bool builtIn = !word.empty() && (word[0] == '$' || word[0] == '*');
        shader_->builtInImage |= builtIn;
        if (image.empty() && !word.empty() && !builtIn)
            image = WithoutExtension(word);
    }
    if (NoImageYet() && !isNormalMap) // the image of `stage normalMap` has no color
        shader_->lightImage = image;
}

void ScriptParser::ParseDirective(std::string_view word) {
    if (const ShaderDirective *directive = FindDirective(word))
        return RunDirective(*directive, word);
    constexpr std::string_view kPrefix = "q3map_";
    const DirectiveContext context{*shader_, table_, scanner_.TokenLocation(), log_};
    if (StartsWithNoCase(word, kPrefix) && !context.ApplyParm(word.substr(kPrefix.size())))
        log_.Warn("unknown shader directive", "{}: shader {}: unknown directive {}{}", context.location.Text(),
                  shader_->info.name, word, NearestDirective(word, table_.GameRules()));
    scanner_.SkipLine();
}

void ScriptParser::RunDirective(const ShaderDirective &directive, std::string_view word) {
    const TextLocation location = scanner_.TokenLocation();
    const std::size_t required = directive.info.MinValues(), most = directive.info.MaxValues();
    words_.clear();
    for (std::string_view next; directive.apply && words_.size() < most && scanner_.NextOnLine(next);)
        if (next != "(" && next != ")")
            words_.emplace_back(next);
    DirectiveContext context{*shader_, table_, location, log_};
    if (directive.apply && words_.size() < required) {
        log_.Warn("incomplete shader directive", "{}: shader {}: {} with {} arguments, expected {}", location.Text(),
                  shader_->info.name, word, words_.size(), required);
    } else if (const std::string fault = directive.apply ? directive.apply(context, words_) : std::string();
               !fault.empty()) {
        log_.Warn("shader directive", "{}: shader {}: {}: {}", location.Text(), shader_->info.name, word, fault);
    }
    if (!StartsWithNoCase(word, "qer_")) // editors read those of any line
        ++shader_->linesRead;
    if (!directive.moreMayFollow)
        scanner_.SkipLine();
}

} // namespace

void ParseShaderScript(TextScanner &scanner, ShaderTable &table, Log &log) {
    ScriptParser(scanner, table, log).ParseScript();
}

} // namespace q3
