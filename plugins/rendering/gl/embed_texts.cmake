# Writes a C++ source that holds text files: cmake -DOUTPUT=FILE "-DFOLDERS=FOLDER;FOLDER" -P embed_texts.cmake
set(entries "")
foreach(folder ${FOLDERS})
  file(GLOB files ${folder}/*.glsl)
  foreach(file ${files})
    get_filename_component(name ${file} NAME)
    file(READ ${file} text)
    string(APPEND entries "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
  endforeach()
endforeach()
file(WRITE ${OUTPUT} "#include \"plugins/rendering/gl/shader_files.h\"

namespace weir::rendering::gl {

static constexpr ShaderFile kFiles[] = {
${entries}};

std::span<const ShaderFile> shaderFiles() {
  return kFiles;
}

}  // namespace weir::rendering::gl
")
