#include "mesh_pass.h"

#include <limits>

#include <mesh_shaders.h>

namespace raymap::view {

namespace {

/// Shares of its distance at which a part is drawn, so that it is seen before the faces that it belongs to.
constexpr float kBeforeFaces = 0.9995F, kEdgesBefore = 0.998F;

}  // namespace

MeshPass::MeshPass(const Gpu& gpu) {
  const VkPushConstantRange push{.stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                                 .size = sizeof(MeshPush)};
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .pushConstantRangeCount = 1,
                                        .pPushConstantRanges = &push};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(vkCreatePipelineLayout(gpu.device(), &info, nullptr, &layout), "making a pipeline's layout");
  layout_ = own(gpu.device(), layout, vkDestroyPipelineLayout);
  faces_ = makePipeline(gpu, kMeshVert, kMeshFrag);
  edges_ = makePipeline(gpu, kEdgeVert, kEdgeFrag);
}

Owned<VkPipeline> MeshPass::makePipeline(const Gpu& gpu, std::span<const uint32_t> vertexCode,
                                         std::span<const uint32_t> fragmentCode) const {
  const Owned<VkShaderModule> vertex = gpu.makeShader(vertexCode), fragment = gpu.makeShader(fragmentCode);
  const VkPipelineShaderStageCreateInfo stages[] = {
      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
       .stage = VK_SHADER_STAGE_VERTEX_BIT,
       .module = vertex.get(),
       .pName = "main"},
      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
       .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
       .module = fragment.get(),
       .pName = "main"}};
  const VkPipelineVertexInputStateCreateInfo input{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  const VkPipelineInputAssemblyStateCreateInfo assembly{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkPipelineViewportStateCreateInfo viewport{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  const VkPipelineRasterizationStateCreateInfo raster{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
      .lineWidth = 1.0F};
  const VkPipelineMultisampleStateCreateInfo samples{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
      .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineDepthStencilStateCreateInfo depth{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
      .depthTestEnable = VK_TRUE,
      .depthWriteEnable = VK_TRUE,
      .depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL};
  const VkPipelineColorBlendAttachmentState blend{
      .blendEnable = VK_TRUE,
      .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
      .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
      .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
      .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
      .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                        VK_COLOR_COMPONENT_A_BIT};
  const VkPipelineColorBlendStateCreateInfo blending{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
      .attachmentCount = 1,
      .pAttachments = &blend};
  const VkDynamicState moving[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  const VkPipelineDynamicStateCreateInfo dynamic{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
      .dynamicStateCount = 2,
      .pDynamicStates = moving};
  const VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                .colorAttachmentCount = 1,
                                                .pColorAttachmentFormats = &format,
                                                .depthAttachmentFormat = kDepthFormat};
  const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                          .pNext = &rendering,
                                          .stageCount = 2,
                                          .pStages = stages,
                                          .pVertexInputState = &input,
                                          .pInputAssemblyState = &assembly,
                                          .pViewportState = &viewport,
                                          .pRasterizationState = &raster,
                                          .pMultisampleState = &samples,
                                          .pDepthStencilState = &depth,
                                          .pColorBlendState = &blending,
                                          .pDynamicState = &dynamic,
                                          .layout = layout_.get()};
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateGraphicsPipelines(gpu.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
        "making a pipeline");
  return own(gpu.device(), pipeline, vkDestroyPipeline);
}

/// Scales positions relative to the eye, which changes depths alone.
void MeshPass::draw(VkCommandBuffer commands, const MeshPart& part, MeshPush push) const {
  const bool isPlain = part.colour == kNoFaces || part.colour == kPlainFaces;
  const float share = part.isEdges ? kEdgesBefore : isPlain ? 1.0F : kBeforeFaces;
  for (int column = 0; column < 3; ++column) push.toClip[column] *= share;
  push.indices = part.indices;
  push.colour = part.colour;
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, part.isEdges ? edges_.get() : faces_.get());
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof push, &push);
  vkCmdDraw(commands, (part.isEdges ? 6 : 3) * part.count, 1, 0, 0);
}

void MeshPass::record(VkCommandBuffer commands, const DeviceMesh& mesh, MeshStyle style,
                      std::span<const MeshPart> parts, const View& view, const Target& target) const {
  const bool isAlone = target.depth == 0;
  const VkRenderingAttachmentInfo colour{
      .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
      .imageView = target.picture.view.get(),
      .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
      .loadOp = isAlone ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
      .clearValue = {.color = {.float32 = {0.94F, 0.945F, 0.955F, 1.0F}}}};
  const VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                        .imageView = target.nearest.view.get(),
                                        .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                        .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                        .clearValue = {.depthStencil = {.depth = 1.0F}}};
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .renderArea = {.extent = target.size},
                             .layerCount = 1,
                             .colorAttachmentCount = 1,
                             .pColorAttachments = &colour,
                             .pDepthAttachment = &depth};
  vkCmdBeginRendering(commands, &info);
  const VkViewport viewport{
      .width = float(target.size.width), .height = float(target.size.height), .maxDepth = 1.0F};
  const VkRect2D scissor{.extent = target.size};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &scissor);
  // From a little in front of the eye to behind the mesh.
  const auto& [camera, bounds, cut, slack] = view;
  const double farthest = glm::length(bounds.centre() - camera.eye()) + glm::length(bounds.size());
  const MeshPush push{
      .toClip = camera.matrix({int(target.size.width), int(target.size.height)}, 1e-4 * farthest, farthest),
      .vertices = mesh.vertices().address,
      .depth = target.depth,
      .origin = mesh.origin() - camera.eye(),
      .width = target.size.width,
      .cutNormal = cut ? glm::vec3(cut->normal) : glm::vec3(0.0F),
      .cutOffset = cut ? float(cut->offset - glm::dot(cut->normal, camera.eye())) : 0.0F,
      .slack = isAlone ? std::numeric_limits<float>::max() : float(slack)};
  if (style != MeshStyle::Hidden)
    draw(commands,
         {.indices = mesh.triangles().address,
          .count = mesh.triangleCount(),
          .colour = style == MeshStyle::Faces ? kPlainFaces : kNoFaces},
         push);
  for (const MeshPart& part : parts) draw(commands, part, push);
  vkCmdEndRendering(commands);
}

}  // namespace raymap::view
