from .pcc_addon import register, unregister  # noqa: F401
