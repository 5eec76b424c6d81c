#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/gl/gl_objects.h"

namespace strata {

/// What batch.glsl, and the shaders that include it, are compiled for.
struct ShaderVariant {
  int views = 1;
  bool clip = false;
  bool classes = false;

  auto operator<=>(const ShaderVariant&) const = default;
  std::string defines() const;
};

/// "#define NAME VALUE" with a line end.
std::string define(const std::string& name, const std::string& value);

/// The variants of one program, each compiled when it is first asked for.
class ProgramCache {
 public:
  ProgramCache(const GlFunctions& functions, std::vector<ShaderStage> stages)
      : gl_(functions), stages_(std::move(stages)) {}

  /// Throws Error where the shader does not compile.
  const GlProgram& get(const ShaderVariant& variant);

 private:
  const GlFunctions& gl_;
  const std::vector<ShaderStage> stages_;
  std::map<ShaderVariant, std::unique_ptr<GlProgram>> programs_;
};

}  // namespace strata
