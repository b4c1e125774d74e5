from .pcc_addon import register, unregister  # noqa: F401
from .pcc_addon.gltf_hooks import glTF2ExportUserExtension, glTF2ImportUserExtension  # noqa: F401
