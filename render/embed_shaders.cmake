# cmake -DOUTPUT=FILE.cpp -DFOLDER=... -DFILES=a,b -P embed_shaders.cmake: the texts as shaderText(), see gl_objects.h.
string(REPLACE "," ";" FILES "${FILES}")
set(cases "")
foreach(file IN LISTS FILES)
  file(READ "${FOLDER}/${file}" text)
  string(APPEND cases "  if (file == \"${file}\")\n    return R\"glsl(${text})glsl\";\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"core/error.h\"
#include \"render/gl/gl_objects.h\"

namespace strata {

std::string_view shaderText(std::string_view file) {
${cases}  throw Error(std::string(file), \"no such shader\");
}

}  // namespace strata
")
