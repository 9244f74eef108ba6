// GPL-2.0-or-later. Parsed shaders: their properties, by name.
#include "q3map2/shader/shader_table.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>

namespace q3 {

namespace {

/// Of q3map_deprecateShader in a row, which may form a circle; limit of this program, chosen.
constexpr int kMaxReplacements = 16;
constexpr float kLeastBacksplash = -900; ///< game units: lower distances mean that none is set

std::string TableKey(std::string_view name) {
    std::string key = LowerCase(name);
    std::replace(key.begin(), key.end(), '\\', '/');
    return key;
}

void ApplyDefaultParm(const Game &game, ShaderInfo &info) {
    const SurfaceParm *parm = game.FindParm("default");
    if (!parm)
        return;
    info.contentFlags = parm->contentSet;
    info.surfaceFlags = parm->surfaceSet;
    info.compileFlags = parm->compileSet;
}

} // namespace

std::string WithoutExtension(std::string_view name) {
    const std::size_t dot = name.find_last_of("./\\");
    return std::string(dot != std::string_view::npos && name[dot] == '.' ? name.substr(0, dot) : name);
}

ShaderTable::ShaderTable(const Game &game, const ShaderOptions &options) : game_(game), options_(options) {
    for (const std::string &name : options.globalFlags) {
        const SurfaceParm *parm = game_.FindParm(name);
        if (!parm)
            throw Error("-globalflag {}: no surfaceparm of game {}", name, game_.name);
        globalFlags_ |= parm->surfaceSet;
    }
}

bool ShaderTable::AddCustomParm(std::string name, std::uint32_t contentFlags, std::uint32_t surfaceFlags) {
    if (customNames_.size() >= kMaxCustomParms)
        return false;
    SurfaceParm parm;
    parm.name = customNames_.emplace_back(std::move(name));
    parm.contentSet = contentFlags;
    parm.surfaceSet = surfaceFlags;
    game_.surfaceParms.push_back(parm);
    return true;
}

void ShaderTable::ApplyGlobalFlags(ShaderInfo &info) const {
    info.surfaceFlags |= globalFlags_;
    if (options_.noOb && (info.compileFlags & C_OB) == 0)
        if (const SurfaceParm *parm = game_.FindParm("noob"))
            info.surfaceFlags |= parm->surfaceSet;
}

ParsedShader ShaderTable::MakeDefault(std::string_view name) const {
    ParsedShader shader;
    shader.info.name = name;
    ApplyDefaultParm(game_, shader.info);
    shader.info.backsplashFraction *= options_.backsplashScale;
    if (options_.backsplashDistance >= kLeastBacksplash)
        shader.info.backsplashDistance = options_.backsplashDistance;
    return shader;
}

void ShaderTable::Define(std::unique_ptr<ParsedShader> shader) {
    std::string key = TableKey(shader->info.name);
    definedCount_ += shaders_.try_emplace(std::move(key), std::move(shader)).second ? 1 : 0;
}

void ShaderTable::ForEach(const std::function<void(ParsedShader &)> &visit) {
    for (auto &[name, shader] : shaders_)
        visit(*shader);
}

std::string ShaderTable::FollowReplacements(std::string_view name, Log &log) const {
    const std::size_t slashes = name.find_first_not_of("/\\"); // engines pass over those in front
    std::string current = WithoutExtension(slashes == std::string_view::npos ? name : name.substr(slashes));
    for (int i = 0; i <= kMaxReplacements; ++i) {
        const auto found = shaders_.find(TableKey(current));
        if (found == shaders_.end() || found->second->replacement.empty())
            return current;
        current = WithoutExtension(found->second->replacement);
    }
    log.Warn("shader replacement", "shader {}: more than {} q3map_deprecateShader in a row", name, kMaxReplacements);
    return current;
}

const ParsedShader *ShaderTable::Find(std::string_view name, Log &log) const {
    const auto found = shaders_.find(TableKey(FollowReplacements(name, log)));
    return found == shaders_.end() ? nullptr : found->second.get();
}

ParsedShader &ShaderTable::FindOrAdd(std::string_view name, Log &log) {
    const std::string finalName = FollowReplacements(name, log);
    std::unique_ptr<ParsedShader> &slot = shaders_[TableKey(finalName)];
    if (!slot)
        slot = std::make_unique<ParsedShader>(MakeDefault(finalName));
    return *slot;
}

} // namespace q3
