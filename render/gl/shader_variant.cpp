#include "render/gl/shader_variant.h"

namespace strata {

std::string define(const std::string& name, const std::string& value) { return "#define " + name + " " + value + "\n"; }

std::string ShaderVariant::defines() const {
  return define("STRATA_VIEWS", std::to_string(views)) + define("STRATA_CLIP", clip ? "1" : "0") +
         define("STRATA_CLASSES", classes ? "1" : "0");
}

const GlProgram& ProgramCache::get(const ShaderVariant& variant) {
  std::unique_ptr<GlProgram>& program = programs_[variant];
  if (program == nullptr) {
    std::vector<ShaderStage> stages = stages_;
    for (ShaderStage& stage : stages) stage.preamble += variant.defines();
    program = std::make_unique<GlProgram>(gl_, stages);
  }
  return *program;
}

}  // namespace strata
